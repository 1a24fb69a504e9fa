"""Readings of several error radii: rnk over all is the sum over the levels, however it is worked out."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.error_radii import ErrorRadii
from robotd.grid.kernels import Kernels
from robotd.grid.readings import Readings
from robotd.grid.ternary import TernaryMap
from robotd.grid.window import CellWindow
from robotd.localization.count.explained import explained_at
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.obstacles.levels import Levels
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.radii import radii_of
from robotd.localization.reference.rank import rank_of
from robotd.localization.search.bounded_search import SearchMap, best_poses
from robotd.localization.settings import LocalizationSettings
from tests.support.kernel_tables import both, using

SPEC = GridSpec(0.1, -0.5, 0.3, (14, 17))
BY_RANGE = LocalizationSettings(error_radius=ErrorRadius.BY_RANGE)
SETTINGS = replace(BY_RANGE, range_error_m=0.1, bearing_error_rad=0.2)
readings = st.builds(
    RangeReading,
    st.just(0),
    st.floats(-math.pi, math.pi),
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.05, 1.5),
)
maps = hnp.arrays(np.uint8, SPEC.shape, elements=st.sampled_from([0, 0, 0, 1, 2]))


def ternary_of(cells: NDArray[np.uint8]) -> TernaryMap:
    return TernaryMap(SPEC, cells == 1, cells == 0)


def levels_of(cells: NDArray[np.uint8]) -> Levels:
    radii = radii_of(SETTINGS, SPEC)
    return Levels.of_map(ternary_of(cells), SETTINGS.unknown, radii, blocked_by=SETTINGS.blocked_by)


@settings(max_examples=60, deadline=None)
@given(maps, st.lists(readings, min_size=1, max_size=6), st.floats(-4.0, 4.0))
def test_counted_level_by_level_it_is_the_papers_count_with_the_radius_of_each_reading(
    cells: NDArray[np.uint8], taken: list[RangeReading], heading_rad: float
) -> None:
    levels = levels_of(cells)
    ranks = RankGrid(levels.maps[0], [heading_rad])
    ranks.add_by_level(Readings.of(taken), levels)
    expected = np.zeros(SPEC.shape, np.int64)
    for reading in taken:
        level = int(levels.radii.levels(np.array([(reading.range_m or 0.0) / SPEC.resolution_m]))[0])
        obstacles = levels.maps[level].obstacles
        ranks_with_rim = rank_of(
            obstacles,
            [reading],
            [heading_rad],
            resolution_m=SPEC.resolution_m,
            error_radius_cells=levels.radii.cells[level],
        )[0]
        expected += ranks_with_rim[obstacles.rim : -obstacles.rim, obstacles.rim : -obstacles.rim]
    assert np.array_equal(ranks.rank[0], expected)
    cell = 5, 8
    assert explained_at(levels, Readings.of(taken), cell, heading_rad).sum() == expected[cell]
    for prepared, which in levels.parted(Readings.of(taken)):
        ranks.remove(Readings.of(taken)[which], prepared)
    assert not ranks.rank.any()


@both
@settings(max_examples=40, deadline=None)
@given(maps, st.lists(readings, min_size=1, max_size=5), st.floats(-4.0, 4.0), st.sampled_from(list(UnknownCells)))
def test_heads_end_at_a_wall_on_the_border_as_they_do_where_the_map_goes_on(
    kernels: Kernels, cells: NDArray[np.uint8], taken: list[RangeReading], heading_rad: float, unknown: UnknownCells
) -> None:
    """The map is cropped: wherever walls lie, what was cut off was never seen. The reference has a map that goes on."""
    more, (rows, cols) = 40, SPEC.shape
    larger = np.pad(cells, more, constant_values=2)
    spec = GridSpec(SPEC.resolution_m, 0.0, 0.0, (rows + 2 * more, cols + 2 * more))
    expected = rank_of(
        Obstacles.of_map(TernaryMap(spec, larger == 1, larger == 0), unknown, 2.5),
        taken,
        [heading_rad],
        resolution_m=SPEC.resolution_m,
        error_radius_cells=2.5,
    )[:, more:-more, more:-more]
    with using(kernels):
        levels = Levels.of_map(ternary_of(cells), unknown, ErrorRadii((2.5,)), blocked_by=1)
        ranks = RankGrid(levels.maps[0], [heading_rad])
        ranks.add(Readings.of(taken))
        found = best_poses(SearchMap.of(levels), Readings.of(taken), np.array([heading_rad]), slack=len(taken))
    assert np.array_equal(ranks.rank, expected)
    assert np.array_equal(found.poses, np.argwhere(expected >= found.least_rank))
    assert np.array_equal(found.ranks, expected[tuple(found.poses.T)])
    assert np.array_equal(ranks.rank_at(found.poses), found.ranks)
    assert explained_at(levels, Readings.of(taken), (0, 8), heading_rad).sum() == expected[0, 0, 8]


@settings(max_examples=40, deadline=None)
@given(maps, st.integers(0, 2**32))
def test_updated_in_a_window_they_are_what_they_are_made_from_nothing(cells: NDArray[np.uint8], seed: int) -> None:
    window, after = CellWindow(0, 9, 5, 8), cells.copy()
    after[window.slices] = np.random.default_rng(seed).integers(0, 3, window.shape)
    levels = levels_of(cells).updated(ternary_of(after), SETTINGS.unknown, window)
    remade = levels_of(after)
    assert levels.radii == remade.radii
    assert len(levels.maps) >= 3
    for one, other in zip(levels.maps, remade.maps, strict=True):
        for name in ("free", "blocking", "grown"):
            assert np.array_equal(getattr(one.obstacles, name), getattr(other.obstacles, name))
        # Tiles begin where free cells do, which may be elsewhere by now: what is counted is the same.
        ranks = [RankGrid(prepared, [0.3]) for prepared in (one, other)]
        for counted in ranks:
            counted.add(Readings.of([RangeReading(0, 0.0, ReadingStatus.OK, 0.8)]))
        assert np.array_equal(ranks[0].rank, ranks[1].rank)


@pytest.mark.parametrize(("cell_m", "least"), [(0.05, 1.5), (0.1, 1.0), (0.2, 1.0)])
def test_a_radius_is_no_less_than_what_cells_round_away(cell_m: float, least: float) -> None:
    spec = GridSpec(cell_m, 0.0, 0.0, (400, 400))
    assert radii_of(BY_RANGE, spec).cells[0] == least
    constant = LocalizationSettings(error_radius=ErrorRadius.CONSTANT)
    assert radii_of(constant, spec).cells == (constant.error_radius_cells(cell_m),)
