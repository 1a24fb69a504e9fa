"""The search kernels: planes renewed in a window are planes made again; every way to search gives the same poses."""

import functools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.grid.error_radii import ErrorRadii
from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.kernels import Kernels
from robotd.grid.kernels.search.search_kernel import BUDGET_MAX, Ground, Planes, Question
from robotd.grid.kernels.twins import TWINS
from robotd.grid.pose_set import PoseSet
from robotd.grid.window import CellWindow
from tests.support.kernel_tables import NATIVE, both, needs_native

RADII = ErrorRadii((1.5, 3.0), (12.0,))


def ground_of(solid: NDArray[np.bool_], outside: bool = True, blocked_by: int = 1) -> Ground:
    grown = np.stack([dilate(solid, disk_footprint(radius), outside=outside) for radius in RADII.cells])
    return Ground(~solid, solid, grown, outside, outside, blocked_by, RADII)


def question_of(shape: tuple[int, int], seed: int, **changes: int) -> Question:
    random = np.random.default_rng(seed)
    readings = np.zeros((20, 5))
    readings[:, 0], readings[:, 1] = np.arange(20) * (math.tau / 20), random.uniform(0.3, 6.0, 20)
    readings[::7, 4] = 1.0
    asked = {"slack": 3, "least_rank": 1, "limit": 1 << 16} | changes
    return Question(
        readings,
        np.linspace(0.0, 0.5, 6),
        resolution_m=0.2,
        **asked,
        window=CellWindow.whole(shape),
        by_blocks=True,
        spans=np.tile(np.array((0, shape[1]), np.int32), (shape[0], 1)),
        reach_cells=500.0,
    )


def building(seed: int, shape: tuple[int, int]) -> NDArray[np.bool_]:
    random = np.random.default_rng(seed)
    blocks = np.kron(random.random((shape[0] // 10 + 1, shape[1] // 12 + 1)) < 0.15, np.ones((10, 12), np.bool_))
    return np.asarray(blocks[: shape[0], : shape[1]] | (random.random(shape) < 0.005))


def assert_same(one: PoseSet, other: PoseSet) -> None:
    assert (one.best_rank, one.least_rank, one.is_all) == (other.best_rank, other.least_rank, other.is_all)
    assert np.array_equal(one.poses, other.poses)
    assert np.array_equal(one.ranks, other.ranks)


@needs_native
@settings(max_examples=60, deadline=None)
@given(
    st.tuples(st.integers(1, 300), st.integers(1, 300)),
    st.booleans(),
    st.integers(0, 2**32),
    st.data(),
)
def test_planes_renewed_in_a_window_are_planes_made_anew(
    shape: tuple[int, int], outside: bool, seed: int, data: st.DataObject
) -> None:
    before = building(seed, shape)
    rows, cols = (sorted((data.draw(st.integers(0, size)), data.draw(st.integers(0, size)))) for size in shape)
    window = CellWindow(*rows, *cols)
    after = before.copy()
    after[window.slices] = np.random.default_rng(seed).random(window.shape) < 0.1
    old, new = ground_of(before, outside), ground_of(after, outside)
    changed = np.argwhere((old.blocking != new.blocking) | (old.grown != new.grown).any(axis=0))
    if len(changed):
        (row_first, col_first), (row_last, col_last) = changed.min(axis=0).tolist(), changed.max(axis=0).tolist()
        window = CellWindow(row_first, row_last + 1, col_first, col_last + 1)
    planes = NATIVE.search.renew_planes(NATIVE.search.make_planes(old), new, window)
    remade: Planes = NATIVE.search.make_planes(new)
    assert np.array_equal(planes.near, remade.near)
    assert np.array_equal(planes.cells, remade.cells)
    assert np.array_equal(planes.pooled, remade.pooled)


@needs_native
def test_near_is_the_chebyshev_distance_to_what_blocks() -> None:
    solid = building(3, (150, 170))
    for outside in (False, True):
        near: NDArray[np.uint8] = NATIVE.search.make_planes(ground_of(solid, outside)).near
        for distance in (1, 2, 5, 17, 40, 63):
            reached = dilate(solid, np.ones((2 * distance - 1, 2 * distance - 1), np.bool_), outside=outside)
            assert np.array_equal(near < distance, reached)


def case(seed: int) -> tuple[Ground, Question]:
    shape = (90 + 40 * seed, 200)
    return ground_of(building(seed, shape), seed != 1, 1 + seed % 2), question_of(shape, seed)


@functools.cache
def found_by_numpy(seed: int) -> PoseSet:
    ground, question = case(seed)
    return TWINS.search.search_poses(TWINS.search.make_planes(ground), question)


@needs_native
@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("instructions", ["portable", "avx2", "avx512"])
def test_every_way_to_search_finds_what_numpy_finds(threads: int, instructions: str) -> None:
    native: Any = NATIVE.search
    for seed in range(3):
        ground, question = case(seed)
        try:
            found = native.search_poses(
                native.make_planes(ground), question, threads=threads, instructions=instructions
            )
        except ValueError:
            pytest.skip(f"this processor has no {instructions}")
        assert len(found.poses)
        assert_same(found, found_by_numpy(seed))


@both
@pytest.mark.parametrize("limit", [0, 1, 50, 300])
def test_more_poses_than_the_limit_are_cut_at_a_rank(kernels: Kernels, limit: int) -> None:
    shape = (40, 100)
    planes = kernels.search.make_planes(ground_of(building(5, shape)))
    everything = kernels.search.search_poses(planes, question_of(shape, 5, slack=20))
    ranks = everything.ranks
    assert len(everything) > 300
    found = kernels.search.search_poses(planes, question_of(shape, 5, slack=20, limit=limit))
    assert (found.best_rank, found.is_all) == (everything.best_rank, False)
    assert np.array_equal(found.poses, everything.poses[ranks >= found.least_rank])
    assert len(found.poses) <= limit < (ranks >= found.least_rank - 1).sum()


@needs_native
def test_planes_that_the_twin_made_are_searched_and_renewed() -> None:
    """So kernels may be chosen again while maps are ready to be searched."""
    ground, question = case(1)
    planes = TWINS.search.make_planes(ground)
    assert_same(NATIVE.search.search_poses(planes, question), found_by_numpy(1))
    renewed = NATIVE.search.renew_planes(planes, ground, CellWindow.whole(ground.free.shape))
    assert_same(NATIVE.search.search_poses(renewed, question), found_by_numpy(1))


@both
def test_with_any_budget_what_is_found_is_there_and_only_with_enough_is_it_all(kernels: Kernels) -> None:
    ground, question = case(2)
    planes, everything = kernels.search.make_planes(ground), found_by_numpy(2)
    known = {tuple(pose): rank for pose, rank in zip(everything.poses.tolist(), everything.ranks, strict=True)}
    cut = 0
    for budget in [0, *(4**power for power in range(14)), BUDGET_MAX]:
        found = kernels.search.search_poses(planes, replace(question, budget=budget))
        assert found.best_rank <= everything.best_rank
        if found.is_all:
            assert_same(found, everything)
        cut += not found.is_all
        for pose, rank in zip(found.poses.tolist(), found.ranks.tolist(), strict=True):
            assert rank == known.get(tuple(pose), rank)
    assert found.is_all
    assert cut > 2


@needs_native
def test_what_a_budget_is_enough_for_does_not_depend_on_threads() -> None:
    """So a recording comes to the same on a machine with more of them."""
    for seed in range(3):
        ground, question = case(seed)
        planes = NATIVE.search.make_planes(ground)
        for budget in (3**power for power in range(4, 18)):
            asked = replace(question, budget=budget)
            alone = NATIVE.search.search_poses(planes, asked)
            for threads in (2, 3, 7):
                assert_same(NATIVE.search.search_poses(planes, asked, threads=threads), alone)


def across_a_hall(headings_rad: list[float]) -> tuple[Ground, Question]:
    """At heading 0 every pose on the middle line explains all readings, at others none explains one."""
    solid = np.ones((100, 320), np.bool_)
    solid[20:81] = False
    readings = np.zeros((140, 5))
    readings[:, 0], readings[:, 1] = np.where(np.arange(140) % 2, math.pi / 2, -math.pi / 2), 31 * 0.2
    question = question_of(solid.shape, 0, slack=0, least_rank=len(readings))
    return ground_of(solid), replace(question, readings=readings, headings_rad=np.array(headings_rad), by_blocks=False)


@needs_native
def test_a_heading_may_have_what_the_others_leave() -> None:
    """Those that are searched together get equal shares, and one that looks like the answer costs far more."""
    ground, alone = across_a_hall([0.0])
    _, among_others = across_a_hall([0.8, 0.0, 1.2, 1.5])
    planes = NATIVE.search.make_planes(ground)

    def is_enough(question: Question, budget: int) -> bool:
        return bool(NATIVE.search.search_poses(planes, replace(question, budget=budget)).is_all)

    enough = next(2**power for power in range(40) if is_enough(alone, 2**power))
    assert enough > 1000
    assert is_enough(among_others, 2 * enough)


@needs_native
def test_all_that_comes_near_is_all_even_if_the_best_rank_was_not_sought_to_the_end() -> None:
    ground, question = case(0)
    planes = NATIVE.search.make_planes(ground)
    for heading_rad in question.headings_rad:
        one = replace(question, headings_rad=np.array([heading_rad]))
        # Enough for bounds, coarse and finer, and then for anything: half of it, for the best rank, is less than they
        # took.
        found = NATIVE.search.search_poses(planes, replace(one, budget=5 * len(one.readings)))
        assert found.is_all
        assert_same(found, NATIVE.search.search_poses(planes, one))
