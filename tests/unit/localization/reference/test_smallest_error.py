"""The smallest error radius: one pass against feasible poses at every eps, and against the binary search."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.binary import BinaryMap
from robotd.grid.distance import distance_transform
from robotd.grid.ternary import TernaryMap
from robotd.localization.erring.error_map import ErrorMap
from robotd.localization.erring.share_errors import errors_on
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.reference.feasible_poses import feasible_poses
from robotd.localization.reference.probe import probe_of
from robotd.localization.reference.smallest_error import (
    errors_for_share,
    errors_for_share_reading_by_reading,
    errors_needed,
    errors_over_headings,
    smallest_error,
    smallest_error_by_search,
)

RESOLUTION_M = 0.25
maps = hnp.arrays(
    np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=10), elements=st.sampled_from([False] * 6 + [True])
).map(lambda occupied: BinaryMap(GridSpec(RESOLUTION_M, 0.0, 0.0, occupied.shape), occupied))
bearings = st.one_of(st.floats(-math.pi, math.pi), st.builds(math.atan2, st.integers(-4, 4), st.integers(-4, 4)))
ranges = st.one_of(st.floats(0.01, 4.0), st.integers(1, 12).map(lambda cells: cells * RESOLUTION_M), st.just(1e6))
readings = st.builds(
    RangeReading,
    st.just(0),
    bearings,
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    ranges,
    origin_x_m=st.sampled_from([0.0, 0.0, 0.25, 0.3]),
    origin_y_m=st.sampled_from([0.0, 0.0, -0.4]),
)
near_readings = readings.filter(lambda reading: (reading.range_m or 0.0) < 10.0)
shares = st.sampled_from([0.1, 0.5, 0.6, 0.9, 1.0])


def feasible_at(binary: BinaryMap, reading: RangeReading, heading_rad: float, error_cells: int) -> NDArray[np.bool_]:
    probe = probe_of(
        reading,
        heading_rad,
        resolution_m=RESOLUTION_M,
        error_radius_cells=error_cells,
        reach_cells=3 * max(binary.spec.shape),
    )
    return feasible_poses(Obstacles.of(binary.occupied, error_cells), probe)


@settings(max_examples=120)
@given(maps, near_readings, bearings)
def test_a_reading_is_feasible_from_its_own_smallest_eps_on_and_not_before_120_cases(
    binary: BinaryMap, reading: RangeReading, heading_rad: float
) -> None:
    distances = distance_transform(binary.occupied, outside=True)
    needed = errors_needed(binary, distances, reading, heading_rad)
    for error_cells in range(20):
        assert np.array_equal(needed <= error_cells, feasible_at(binary, reading, heading_rad, error_cells))


@settings(max_examples=120)
@given(maps, st.lists(near_readings, min_size=1, max_size=6), bearings, shares)
def test_for_a_share_each_cell_has_the_eps_at_which_so_many_are_feasible_120_cases(
    binary: BinaryMap, several: list[RangeReading], heading_rad: float, share: float
) -> None:
    errors = errors_for_share(binary, several, heading_rad, share)
    for error_cells in range(18):
        rank = sum(feasible_at(binary, reading, heading_rad, error_cells).astype(int) for reading in several)
        assert np.array_equal(errors <= error_cells, rank >= math.ceil(share * len(several) - 1e-9))


@settings(max_examples=120)
@given(maps, st.lists(readings, min_size=1, max_size=6), bearings, shares)
def test_one_pass_finds_what_the_search_finds_120_cases(
    binary: BinaryMap, several: list[RangeReading], heading_rad: float, share: float
) -> None:
    one_pass = smallest_error(binary, several, heading_rad, share)
    search = smallest_error_by_search(binary, several, heading_rad, share)
    if one_pass is None or search is None:
        assert one_pass is search
        return
    assert one_pass.error_cells == search.error_cells
    assert np.array_equal(one_pass.cells, search.cells)


@settings(max_examples=60)
@given(maps, st.lists(near_readings, min_size=1, max_size=6), st.lists(bearings, min_size=1, max_size=3), shares)
def test_tile_by_tile_is_reading_by_reading_and_the_best_slice_is_the_least_60_cases(
    binary: BinaryMap, several: list[RangeReading], headings_rad: list[float], share: float
) -> None:
    slow = [errors_for_share_reading_by_reading(binary, several, one, share) for one in headings_rad]
    errors, which = errors_over_headings(ErrorMap.of_binary(binary), several, headings_rad, share, threads=2)
    assert np.array_equal(errors, np.min(slow, axis=0))
    assert np.array_equal(which, np.argmin(slow, axis=0))


values = hnp.arrays(
    np.int8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=9), elements=st.sampled_from([0, 0, 0, 0, 1, 2])
)


@settings(max_examples=60)
@given(
    values,
    st.sampled_from(UnknownCells),
    st.integers(1, 2),
    st.lists(near_readings, min_size=1, max_size=4),
    bearings,
    shares,
)
def test_maps_of_three_values_and_grazing_beams_need_what_they_need_60_cases(
    cells: NDArray[np.int8],
    unknown: UnknownCells,
    blocked_by: int,
    several: list[RangeReading],
    heading_rad: float,
    share: float,
) -> None:
    ternary = TernaryMap(GridSpec(RESOLUTION_M, 0.0, 0.0, cells.shape), cells == 1, cells == 0)
    read = [Obstacles.of_map(ternary, unknown, float(error), blocked_by=blocked_by) for error in range(14)]
    errors = errors_on(ErrorMap.of(read[0], ternary.spec), several, heading_rad, share)
    reach_cells = 2 * max(cells.shape)
    for error, obstacles in enumerate(read):
        rank = np.zeros(cells.shape, int)
        for reading in several:
            probe = probe_of(
                reading,
                heading_rad,
                resolution_m=RESOLUTION_M,
                error_radius_cells=error,
                reach_cells=reach_cells,
            )
            rank += feasible_poses(obstacles, probe)
        assert np.array_equal(errors <= error, rank >= math.ceil(share * len(several) - 1e-9))


def test_a_large_map_is_solved_in_every_tile() -> None:
    random = np.random.default_rng(0)
    occupied = random.random((150, 200)) < 0.01
    binary = BinaryMap(GridSpec(0.05, 0.0, 0.0, occupied.shape), occupied)
    sweep = [RangeReading(0, k / 4, ReadingStatus.OK, float(random.uniform(0.2, 5.0))) for k in range(25)]
    fast = errors_for_share(binary, sweep, 0.3, 0.7, threads=2)
    assert np.array_equal(fast, errors_for_share_reading_by_reading(binary, sweep, 0.3, 0.7))


ROOM = BinaryMap(
    GridSpec(RESOLUTION_M, 0.0, 0.0, (7, 9)),
    np.pad(np.zeros((5, 7), np.bool_), 1, constant_values=True),
)


def measured(bearing_deg: float, range_cells: float) -> RangeReading:
    return RangeReading(0, math.radians(bearing_deg), ReadingStatus.OK, range_cells * RESOLUTION_M)


def test_readings_without_error_need_none_and_find_the_cell() -> None:
    """From cell (2, 3): five cells to the wall ahead, four up, three back, two down."""
    sweep = [measured(0, 5), measured(90, 4), measured(180, 3), measured(-90, 2)]
    found = smallest_error(ROOM, sweep, 0.0)
    assert found is not None
    assert (found.error_cells, found.cells.tolist()) == (0, [[2, 3]])


def test_a_reading_that_contradicts_the_others_costs_error_or_a_smaller_share() -> None:
    sweep = [measured(0, 2), measured(90, 4), measured(180, 3), measured(-90, 2)]
    strict, lenient = (smallest_error(ROOM, sweep, 0.0, share) for share in (1.0, 0.75))
    assert strict is not None
    assert lenient is not None
    assert strict.error_cells == 1  # beside the lower wall: it is one cell from the ends of both beams along it
    assert set(strict.cells[:, 0].tolist()) == {1}
    assert (lenient.error_cells, lenient.cells.tolist()) == (0, [[2, 3], [2, 6]])


def test_where_nothing_is_free_no_error_is_great_enough() -> None:
    solid = BinaryMap(GridSpec(RESOLUTION_M, 0.0, 0.0, (3, 3)), np.ones((3, 3), np.bool_))
    assert smallest_error(solid, [measured(0, 2)], 0.0) is None
    assert smallest_error_by_search(solid, [measured(0, 2)], 0.0) is None


def test_what_makes_no_sense_is_refused() -> None:
    weak = RangeReading(0, 0.0, ReadingStatus.WEAK, None)
    with pytest.raises(ValueError, match="at least one"):
        smallest_error(ROOM, [], 0.0)
    with pytest.raises(ValueError, match="share"):
        smallest_error(ROOM, [measured(0, 2)], 0.0, 0.0)
    with pytest.raises(ValueError, match="32000"):
        errors_on(ErrorMap.of_binary(ROOM), [measured(0, 40_000)], 0.0)
    for find in (smallest_error, smallest_error_by_search):
        with pytest.raises(ValueError, match="weak"):
            find(ROOM, [weak], 0.0)
