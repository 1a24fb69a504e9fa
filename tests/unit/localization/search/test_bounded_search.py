"""The search against the count of everything: always the same poses, whatever the map and the question."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.error_radii import ErrorRadii
from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.kernels import Kernels
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.grid.window import CellWindow
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.levels import Levels
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.reference.rank import rank_of
from robotd.localization.search import bounded_search as search
from robotd.localization.search.bounded_search import SearchMap, best_poses
from robotd.localization.search.cell_disk import CellDisk
from tests.support.kernel_tables import both, using

RESOLUTION_M = 0.5


@st.composite
def some_levels(draw: st.DrawFn) -> Levels:
    """A map read in any way, for up to three levels of readings, some of which may have no reading."""
    shape = draw(st.tuples(st.integers(1, 30), st.integers(1, 70)))
    random = np.random.default_rng(draw(st.integers(0, 2**32)))
    radii = sorted(draw(st.lists(st.sampled_from([0.0, 1.0, 1.5, 3.0, 9.0]), min_size=1, max_size=3)))
    begins = sorted(draw(st.lists(st.floats(1.0, 20.0), min_size=len(radii) - 1, max_size=len(radii) - 1)))
    solid = np.kron(random.random((4, 8)) < draw(st.sampled_from([0.0, 0.3])), np.ones((8, 9), np.bool_))
    solid = solid[: shape[0], : shape[1]] | (random.random(shape) < draw(st.sampled_from([0.0, 0.03, 0.3])))
    unknown = random.random(shape) < draw(st.sampled_from([0.0, 0.1]))
    ends = solid if draw(st.booleans()) else solid | unknown
    outside_ends = draw(st.booleans())
    free, blocking = ~solid & ~unknown, solid | unknown if draw(st.booleans()) else solid
    outside_blocks, blocked_by = draw(st.booleans()), draw(st.sampled_from([1, 2]))
    spec = GridSpec(RESOLUTION_M, 0.0, 0.0, shape)

    def grown_by(radius: float) -> PreparedMap:
        grown = dilate(ends, disk_footprint(radius), outside=outside_ends)
        obstacles = Obstacles(free, blocking, grown, outside_blocks, outside_ends, blocked_by)
        return PreparedMap.of(obstacles, spec, radius)

    return Levels(ErrorRadii(tuple(radii), tuple(begins)), tuple(map(grown_by, radii)))


origins = st.sampled_from([0.0, 0.0, 0.0, 0.7, -1.2])
readings = st.lists(
    st.builds(
        RangeReading,
        st.just(0),
        st.one_of(st.floats(-4.0, 4.0), st.integers(0, 8).map(lambda k: math.tau * k / 8)),
        st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
        st.one_of(st.floats(0.1, 12.0), st.sampled_from([0.5, 3.0, 3.25, 1e9])),
        origin_x_m=origins,
        origin_y_m=origins,
    ),
    min_size=1,
    max_size=12,
)
headings = st.lists(st.floats(-4.0, 4.0), min_size=1, max_size=3)
eighths = st.integers(-40, 480).map(lambda eighths: eighths / 8)
priors = st.one_of(
    st.none(),
    st.none(),
    st.builds(CellDisk, eighths, eighths, st.integers(0, 240).map(lambda eighths: eighths / 8)),
    st.builds(CellWindow, *[st.integers(-5, 70)] * 4),
)


def counted(levels: Levels, sweep: list[RangeReading], headings_rad: list[float]) -> NDArray[np.int64]:
    """Every rank, -1 where nobody stands, ``int64[headings, rows, cols]``: reading by reading."""
    rank = np.zeros((len(headings_rad), *levels.spec.shape), np.int64)
    begins = (*levels.radii.begins, math.inf)
    for reading in sweep:
        level = next(number for number, begin in enumerate(begins) if (reading.range_m or 0.0) / RESOLUTION_M < begin)
        obstacles, radius = levels.maps[level].obstacles, levels.radii.cells[level]
        rank += rank_of(obstacles, [reading], headings_rad, resolution_m=RESOLUTION_M, error_radius_cells=radius)
    return np.where(levels.obstacles.free, rank, -1)


def asked_for(prior: CellDisk | CellWindow | None, shape: tuple[int, int]) -> NDArray[np.bool_]:
    row, col = np.indices(shape)
    match prior:
        case None:
            return np.ones(shape, np.bool_)
        case CellDisk():
            return np.asarray((row - prior.row) ** 2 + (col - prior.col) ** 2 <= prior.radius**2)
        case CellWindow():
            rows = (prior.first_row <= row) & (row < prior.end_row)
            return np.asarray(rows & (prior.first_col <= col) & (col < prior.end_col))


def assert_is(found: PoseSet, ranks: NDArray[np.int64], slack: int, least_rank: int) -> None:
    best = int(ranks.max(initial=0))
    least = max(1, best - slack)
    expected = np.argwhere(ranks >= least)
    if best < least_rank or best < 1:
        assert (found.best_rank, len(found.poses), len(found.ranks)) == (0, 0, 0)
        return
    assert (found.best_rank, found.least_rank) == (best, least)
    assert np.array_equal(found.poses, expected)
    assert np.array_equal(found.ranks, ranks[tuple(expected.T)])


@both
@settings(max_examples=150, deadline=None)
@given(some_levels(), readings, headings, priors, st.integers(0, 4), st.integers(0, 8), st.booleans())
def test_the_answer_is_that_of_counting_everything(
    kernels: Kernels,
    levels: Levels,
    sweep: list[RangeReading],
    headings_rad: list[float],
    prior: CellDisk | CellWindow | None,
    slack: int,
    least_rank: int,
    in_blocks: bool,
) -> None:
    with using(kernels), pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "_FEW_CELLS", 0 if in_blocks else 1 << 30)
        ready = SearchMap.of(levels)
        found = best_poses(
            ready, Readings.of(sweep), np.array(headings_rad), slack=slack, least_rank=least_rank, prior=prior
        )
    ranks = counted(levels, sweep, headings_rad)
    ranks[:, ~asked_for(prior, levels.spec.shape)] = -1
    assert_is(found, ranks, slack, least_rank)


@both
def test_heads_farther_outside_than_blocks_see_are_found(kernels: Kernels) -> None:
    """Where the outside ends beams: no wall, a beam of 20 cells, and few poses from which it ends near the map."""
    free = np.ones((10, 17), np.bool_)
    obstacles = Obstacles(free, ~free, free, outside_blocks=True, outside_ends=True)
    sweep = [RangeReading(0, 3.9375, ReadingStatus.OK, 10.0, origin_y_m=-1.2)]
    with using(kernels), pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "_FEW_CELLS", 0)
        for radius, poses in ((9.0, 10), (3.0, 0)):
            ready = SearchMap.of(Levels.of(obstacles, GridSpec(RESOLUTION_M, 0.0, 0.0, free.shape), radius))
            found = best_poses(ready, Readings.of(sweep), np.array([0.0]), slack=0)
            assert (found.best_rank, len(found.poses)) == (min(1, poses), poses)
