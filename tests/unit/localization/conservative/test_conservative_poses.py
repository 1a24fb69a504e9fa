"""The conservative mode never loses the true pose, counts what it defines, and tells when its bounds are too small."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.fans import direction_keys, draw_fans, start_keys
from robotd.grid.readings import Readings
from robotd.grid.ternary import TernaryMap
from robotd.localization.conservative.conservative_poses import ErrorBounds, SureObstacles, conservative_poses
from robotd.localization.conservative.conservative_rank import ConservativeMap, ConservativeRankGrid
from robotd.localization.even_headings import even_headings
from tests.studies.conservative.run import is_lost, ranks_of
from tests.support.conservative_cases import case_of

RESOLUTION_M = 0.25
values = hnp.arrays(
    np.int8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=10), elements=st.sampled_from([0, 0, 0, 0, 1, 2])
)
angles = st.one_of(st.floats(-4.0, 4.0), st.integers(-8, 8).map(lambda k: k * math.pi / 4))
readings = st.builds(
    RangeReading,
    st.just(0),
    angles,
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.one_of(st.floats(0.01, 3.0), st.just(1e5)),
    origin_x_m=st.sampled_from([0.0, 0.0, 0.3, -0.6]),
    origin_y_m=st.sampled_from([0.0, 0.0, 0.4]),
)
bounds_of = st.builds(ErrorBounds, st.sampled_from([0.0, 0.1, 0.3]), st.sampled_from([0.0, 0.01, 0.1, 0.39]))


def obstacles_of(cells: NDArray[np.int8], *, ternary: bool) -> SureObstacles:
    if not ternary:
        return SureObstacles.of(cells > 0)
    return SureObstacles.of_map(TernaryMap(GridSpec(RESOLUTION_M, 0.0, 0.0, cells.shape), cells == 1, cells == 0))


def test_the_true_pose_is_never_lost_500_cases(record_property: Callable[[str, object], None]) -> None:
    cases = range(500)
    assert [seed for seed in cases if is_lost(case_of(seed))] == []
    record_property("property_cases", len(cases))


def test_bounds_that_are_too_small_do_lose_it() -> None:
    """So the cases are hard enough to find out."""
    assert sum(is_lost(case_of(seed), share_of_bounds=0.5) for seed in range(300)) > 5


def test_readings_that_break_their_bounds_cost_no_more_than_one_each() -> None:
    for seed in range(40):
        case = case_of(seed)
        wrong = [RangeReading(0, reading.bearing_rad, ReadingStatus.OK, 0.1) for reading in case.readings[::4]]
        kept = [reading for number, reading in enumerate(case.readings) if number % 4]
        ranks = ranks_of(case, even_headings(case.slices))
        ranks.add(Readings.of((*kept, *wrong)))
        poses = ranks.cells_of_rank(ranks.readings - len(wrong))
        assert (poses == (case.slice_number, *case.cell)).all(axis=1).any()


@settings(max_examples=100)
@given(values, st.booleans(), st.lists(readings, min_size=1, max_size=5), bounds_of, st.lists(angles, max_size=3))
def test_what_is_counted_is_what_is_defined_100_cases(
    cells: NDArray[np.int8], ternary: bool, sweep: list[RangeReading], bounds: ErrorBounds, headings: list[float]
) -> None:
    obstacles = obstacles_of(cells, ternary=ternary)
    spec = GridSpec(RESOLUTION_M, 0.0, 0.0, cells.shape)
    ranks = ConservativeRankGrid(ConservativeMap.of(obstacles, spec, bounds), [0.0, *headings])
    ranks.add(Readings.of(sweep))
    for rank, heading in zip(ranks.rank, ranks.headings_rad, strict=True):
        planes = (conservative_poses(obstacles, reading, heading, RESOLUTION_M, bounds) for reading in sweep)
        assert np.array_equal(rank, sum(plane.astype(np.uint16) for plane in planes))
    ranks.remove(Readings.of(sweep))
    assert ranks.best_rank == 0


def slow_pose(
    obstacles: SureObstacles, reading: RangeReading, heading: float, bounds: ErrorBounds, cell: tuple[int, int]
) -> bool:
    """Ask one cell: is there a path through the windows, and an obstacle near the head?"""

    def at(cells: NDArray[np.bool_], row: int, col: int, outside: bool) -> bool:
        return bool(cells[row, col]) if 0 <= row < cells.shape[0] and 0 <= col < cells.shape[1] else outside

    assert reading.range_m is not None
    sin, cos = math.sin(heading), math.cos(heading)
    x, y = reading.origin_x_m / RESOLUTION_M, reading.origin_y_m / RESOLUTION_M
    start, bearing = (sin * x + cos * y, cos * x - sin * y), heading + reading.bearing_rad
    error, length = bounds.range_error_m / RESOLUTION_M, reading.range_m / RESOLUTION_M
    fans = draw_fans(direction_keys(np.array([bearing])), start_keys(np.array([start])), bounds.heading_error_rad, 60)
    axis, forward, first, least, greatest, _, at_home = fans.lines[0].tolist()
    count = int(fans.lines_crossed(np.zeros(1, np.intp), np.array([length - error]))[0])

    def is_open(line: int, aside: int) -> bool:
        row, col = (line, aside) if axis == 0 else (aside, line)
        return not at(obstacles.blocking, cell[0] + row, cell[1] + col, obstacles.outside_blocks)

    line, ends = 0, {0} if at_home else None
    for number, (low, high) in enumerate(fans.windows[:count].tolist()):
        here, met = forward * (first + number), set()
        for aside in range(low, high + 1):
            from_where = [end for end in ends or () if number == 0 or least <= aside - end <= greatest]
            reached = any(
                end == aside or is_open(line, end + (1 if aside > end else -1)) or is_open(here, end)
                for end in from_where
            )
            if is_open(here, aside) and (ends is None or reached):
                met.add(aside)
        line, ends = here, met
    if not at(obstacles.standing, *cell, False) or ends == set():
        return False
    head = (start[0] + length * math.sin(bearing), start[1] + length * math.cos(bearing))
    radius = math.ceil(4 * (error + 2 * math.sin(bounds.heading_error_rad / 2) * math.hypot(*head) + 1e-4)) / 4
    row, col = (cell[k] + math.floor(head[k] + 0.5) for k in range(2))
    reach = int(radius + 1.5)
    around = [(i, j) for i in range(-reach, reach + 1) for j in range(-reach, reach + 1)]
    return reading.status is ReadingStatus.MISS or any(
        at(obstacles.ending, row + i, col + j, True)
        for i, j in around
        if math.hypot(max(abs(i) - 1.5, 0.0), max(abs(j) - 1.5, 0.0)) <= radius
    )


@settings(max_examples=60)
@given(values, st.booleans(), readings.filter(lambda reading: (reading.range_m or 0.0) < 9.0), bounds_of, angles)
def test_the_reference_asks_every_cell_the_same_60_cases(
    cells: NDArray[np.int8], ternary: bool, reading: RangeReading, bounds: ErrorBounds, heading: float
) -> None:
    obstacles = obstacles_of(cells, ternary=ternary)
    poses = conservative_poses(obstacles, reading, heading, RESOLUTION_M, bounds)
    for cell in np.ndindex(cells.shape):
        assert poses[cell] == slow_pose(obstacles, reading, heading, bounds, (cell[0], cell[1]))


def test_a_thin_wall_hides_what_is_behind_it_and_a_gap_does_not() -> None:
    """Two rooms, a wall of one cell between them, at a slant too: E says something."""
    for wall in (np.arange(20) * 0 + 10, np.arange(20)):
        occupied = np.zeros((20, 20), np.bool_)
        occupied[np.arange(20), wall] = True
        reading = RangeReading(0, 0.0, ReadingStatus.MISS, 9.0)
        obstacles, bounds = SureObstacles.of(occupied), ErrorBounds(0.5, 0.01)
        poses = conservative_poses(obstacles, reading, 0.0, 1.0, bounds)
        assert not poses[8, wall[8] - 5 : wall[8]].any()
        occupied[np.arange(5, 12), wall[5:12]] = False
        assert conservative_poses(SureObstacles.of(occupied), reading, 0.0, 1.0, bounds)[8, 4]


@pytest.mark.parametrize(("field", "value"), [("range_error_m", -1.0), ("heading_error_rad", 0.5)])
def test_impossible_bounds_are_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        ErrorBounds(**{"range_error_m": 0.1, "heading_error_rad": 0.1, field: value})


def test_a_reading_that_measured_nothing_is_refused() -> None:
    obstacles, bounds = SureObstacles.of(np.zeros((3, 3), np.bool_)), ErrorBounds(0.1, 0.1)
    weak = RangeReading(0, 0.0, ReadingStatus.WEAK, None)
    with pytest.raises(ValueError, match="weak"):
        conservative_poses(obstacles, weak, 0.0, 1.0, bounds)
    ranks = ConservativeRankGrid(
        ConservativeMap.of(obstacles, GridSpec(1.0, 0.0, 0.0, (3, 3)), bounds), even_headings(4)
    )
    with pytest.raises(ValueError, match="weak"):
        ranks.add(Readings.of((weak,)))
