"""Blocks of cells bound their cells: a search that looks at blocks first loses no pose, wherever the heads lie."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.error_radii import ErrorRadii
from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.kernels.search.search_kernel import Ground, Question
from robotd.grid.window import CellWindow
from tests.support.kernel_tables import NATIVE, needs_native

HEADINGS_RAD = np.linspace(0.0, math.tau, 120, endpoint=False)

shapes = st.one_of(
    st.tuples(st.integers(1, 40), st.integers(1, 90)),
    st.tuples(st.integers(1, 3), st.integers(1, 300)),  # thinner than a block
    st.tuples(st.integers(1, 300), st.integers(1, 3)),
    st.tuples(st.sampled_from([16, 64, 128]), st.sampled_from([32, 64, 128, 256])),  # whole words of blocks
    st.tuples(st.integers(1, 300), st.integers(1, 300)),
)


def ground_of(shape: tuple[int, int], radius: float, outside: tuple[bool, bool], seed: int) -> Ground:
    """Return a map of which few cells are asked for, with walls of any thickness along its sides."""
    random = np.random.default_rng(seed)
    blocking = random.random(shape) < random.choice([0.0, 0.02, 0.1, 0.6])
    for _ in range(4):
        blocking[: random.choice([0, 0, 3, 8])] = True
        blocking = np.ascontiguousarray(np.rot90(blocking))
    blocks, ends = outside
    radii = ErrorRadii((0.0, radius), (float(random.choice([0.0, 1e9])),))  # read on one level or the other
    grown = np.stack([dilate(blocking, disk_footprint(each), outside=ends) for each in radii.cells])
    free = ~blocking & (random.random(shape) < 0.05)
    return Ground(free, blocking, grown, blocks, ends, int(random.integers(1, 3)), radii)


def question_of(shape: tuple[int, int], range_cells: float, start: float) -> Question:
    return Question(
        np.array([[0.0, range_cells, start, 0.0, 0.0]]),
        HEADINGS_RAD,
        resolution_m=1.0,
        slack=0,
        least_rank=1,
        limit=1 << 20,
        window=CellWindow.whole(shape),
        by_blocks=True,
        spans=np.tile(np.array((0, shape[1]), np.int32), (shape[0], 1)),
        reach_cells=1000.0,
    )


@needs_native
@pytest.mark.parametrize("outside", [(True, True), (True, False), (False, False), (False, True)])
@settings(max_examples=40, deadline=None)
@given(
    shapes,
    st.sampled_from([0.0, 1.0, 1.5, 3.0, 6.0, 9.0]),
    st.sampled_from([0.0, 0.0, 1.4, -2.4]),
    st.integers(0, 2**32),
)
def test_blocks_lose_no_pose(
    outside: tuple[bool, bool], shape: tuple[int, int], radius: float, start: float, seed: int
) -> None:
    """One reading at a time, so that one bound too low is a pose that is missing; outside blocks and ends, or not."""
    planes = NATIVE.search.make_planes(ground_of(shape, radius, outside, seed))
    for range_cells in np.random.default_rng(seed).uniform(0.1, (12.0, 40.0, 300.0)):
        by_blocks = question_of(shape, range_cells, start)
        found = NATIVE.search.search_poses(planes, by_blocks)
        expected = NATIVE.search.search_poses(planes, replace(by_blocks, by_blocks=False))
        assert found.best_rank == expected.best_rank
        assert np.array_equal(found.poses, expected.poses)
