"""The occupancy grid against a loop over readings and cells."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.binary import BinaryMap
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings, OverRange, UpdatePolicy

SPEC = GridSpec(0.5, -3.0, -2.0, (9, 13))


def reading(
    bearing_rad: float, range_m: float, status: ReadingStatus = ReadingStatus.OK, x_m: float = 0.0
) -> RangeReading:
    return RangeReading(0, bearing_rad, status, range_m, origin_x_m=x_m)


def sweep_of(*readings: RangeReading) -> Sweep:
    return Sweep(0, IDENTITY, readings)


measured = st.builds(
    reading,
    st.floats(-math.pi, math.pi),
    st.floats(0.05, 9.0),
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(-0.7, 0.7),
)
unmeasured = st.builds(
    lambda status: RangeReading(0, 0.3, status, None), st.sampled_from([ReadingStatus.WEAK, ReadingStatus.TIMEOUT])
)
sweeps = st.lists(st.one_of(measured, measured, unmeasured), max_size=8).map(lambda readings: sweep_of(*readings))
poses = st.builds(Pose2, st.floats(-5.0, 5.0), st.floats(-4.0, 4.0), st.floats(-math.pi, math.pi))
all_settings = st.builds(
    GridSettings,
    policy=st.sampled_from(UpdatePolicy),
    over_range=st.sampled_from(OverRange),
    raise_alpha=st.floats(0, 0.9),
)


def slow_beam(one: RangeReading, pose: Pose2, spec: GridSpec) -> tuple[list[tuple[int, int]], tuple[int, int] | None]:
    """Cells passed, and the cell hit, of one reading; no clipping."""
    assert one.range_m is not None
    x_m, y_m = pose.transform(one.origin_x_m, one.origin_y_m)
    bearing = pose.heading_rad + one.bearing_rad
    sin, cos = math.sin(bearing), math.cos(bearing)
    dominant = max(abs(sin), abs(cos))
    row, col = (y_m - spec.origin_y_m) / spec.resolution_m, (x_m - spec.origin_x_m) / spec.resolution_m
    passed, k = [], 0
    while k < one.range_m / spec.resolution_m * dominant:
        passed.append((math.floor(row + k * (sin / dominant)), math.floor(col + k * (cos / dominant))))
        k += 1
    hit = spec.cell_at(x_m + one.range_m * cos, y_m + one.range_m * sin)
    if one.status is ReadingStatus.MISS or not spec.contains(*hit):
        return passed, None
    return passed, hit


def lowered(value: int, alpha: float) -> int:
    new = min(round(alpha * value), max(value - 1, 0))
    return 127 if new == 128 else new


def raised(value: int, alpha: float) -> int:
    doubt = 255 - value
    new = 255 - min(round(alpha * doubt), max(doubt - 1, 0))
    return 129 if new == 128 else new


def slow_insert(cells: NDArray[np.uint8], sweep: Sweep, pose: Pose2, rules: GridSettings) -> None:
    usable = [r for r in sweep.measured if rules.over_range is OverRange.CLEAR or r.status is ReadingStatus.OK]
    beams = [slow_beam(one, pose, SPEC) for one in usable]
    if rules.policy is UpdatePolicy.PER_SWEEP:
        hits = {hit for _, hit in beams if hit is not None}
        groups = [({cell for passed, _ in beams for cell in passed} - hits, hits)]
    else:
        groups = [(set(passed) - {hit}, set() if hit is None else {hit}) for passed, hit in beams]
    for vacant, full in groups:
        for cell in vacant:
            if SPEC.contains(*cell):
                cells[cell] = lowered(int(cells[cell]), rules.lower_alpha)
        for cell in full:
            cells[cell] = raised(int(cells[cell]), rules.raise_alpha)


@settings(max_examples=150)
@given(st.lists(st.tuples(sweeps, poses), max_size=3), all_settings)
def test_insert_is_the_loop_over_readings_and_cells(stops: list[tuple[Sweep, Pose2]], rules: GridSettings) -> None:
    grid = OccupancyGrid(SPEC, settings=rules)
    expected = np.full(SPEC.shape, 128, np.uint8)
    for sweep, pose in stops:
        before = expected.copy()
        slow_insert(expected, sweep, pose, rules)
        changed = grid.insert(sweep, pose)
        assert np.array_equal(grid.cells, expected)
        assert changed.tolist() == np.flatnonzero(before != expected).tolist()


def test_a_drawn_hit() -> None:
    grid = OccupancyGrid(GridSpec(1.0, 0.0, 0.0, (3, 6)))
    changed = grid.insert(sweep_of(reading(0.0, 4.0)), Pose2(0.5, 1.5, 0.0))
    assert grid.cells.tolist() == [[128] * 6, [19, 19, 19, 19, 217, 128], [128] * 6]
    assert changed.tolist() == [6, 7, 8, 9, 10]


def test_a_hit_beats_the_misses_of_its_sweep_but_not_the_next_reading_in_the_papers_policy() -> None:
    sweep = sweep_of(reading(0.0, 2.0), reading(0.0, 4.0))
    spec, pose = GridSpec(1.0, 0.0, 0.0, (1, 6)), Pose2(0.5, 0.5, 0.0)
    at_once, one_by_one = (
        OccupancyGrid(spec),
        OccupancyGrid(spec, settings=GridSettings(policy=UpdatePolicy.PER_READING)),
    )
    at_once.insert(sweep, pose)
    one_by_one.insert(sweep, pose)
    assert at_once.cells.tolist() == [[19, 19, 217, 19, 217, 128]]
    assert one_by_one.cells.tolist() == [[3, 3, 33, 19, 217, 128]]


def test_a_miss_clears_up_to_the_cut_off_or_says_nothing() -> None:
    sweep, spec = sweep_of(reading(0.0, 2.5, ReadingStatus.MISS)), GridSpec(1.0, 0.0, 0.0, (1, 4))
    clear, discard = OccupancyGrid(spec), OccupancyGrid(spec, settings=GridSettings(over_range=OverRange.DISCARD))
    clear.insert(sweep, Pose2(0.5, 0.5, 0.0))
    assert clear.cells.tolist() == [[19, 19, 19, 128]]
    assert discard.insert(sweep, Pose2(0.5, 0.5, 0.0)).size == 0


def test_a_sweep_without_readings_changes_nothing() -> None:
    assert OccupancyGrid(SPEC).insert(sweep_of(), IDENTITY).size == 0


def test_a_reading_beyond_all_measure_is_clipped() -> None:
    grid = OccupancyGrid(SPEC)
    assert grid.insert(sweep_of(reading(0.0, 1e12)), IDENTITY).size > 0
    assert (grid.cells <= 128).all()


def test_the_digest_tells_maps_apart_by_cells_and_by_place() -> None:
    grid = OccupancyGrid(SPEC)
    same = OccupancyGrid(SPEC, grid.cells)
    assert grid.digest() == same.digest()
    assert grid.digest() != OccupancyGrid(dataclasses.replace(SPEC, origin_x_m=-3.0000000000000004)).digest()
    same.cells[0, 0] = 127
    assert grid.digest() != same.digest()


def test_unknown_cells_are_occupied_in_the_binary_map() -> None:
    cells = np.array([[0, 127, 128, 129, 255]], np.uint8)
    binary = BinaryMap.from_grid(OccupancyGrid(GridSpec(1.0, 0.0, 0.0, (1, 5)), cells))
    assert binary.occupied.tolist() == [[False, False, True, True, True]]


def test_cells_of_another_shape_or_type_are_refused() -> None:
    with pytest.raises(ValueError, match="expected uint8"):
        OccupancyGrid(SPEC, np.zeros((2, 2), np.uint8))
    with pytest.raises(ValueError, match="expected bool"):
        BinaryMap(SPEC, np.zeros((2, 2), np.bool_))


def test_the_default_grid_is_lilys_with_the_stops_round_its_middle() -> None:
    spec = GridSettings().spec_covering(((0.0, 0.0), (2.0, 4.0)), 3.0)
    assert spec.shape == (256, 256)
    assert spec.cell_at(1.0, 2.0) == (128, 128)


@given(st.lists(st.tuples(st.floats(-40.0, 40.0), st.floats(-40.0, 40.0)), min_size=1, max_size=5))
def test_a_new_grid_reaches_beyond_every_stop(stops_m: list[tuple[float, float]]) -> None:
    spec = GridSettings().spec_covering(stops_m, 3.0)
    assert spec.rows >= 256
    assert spec.cols >= 256
    for x_m, y_m in stops_m:
        for away_x_m, away_y_m in ((-2.99, -2.99), (2.99, 2.99)):
            assert spec.contains(*spec.cell_at(x_m + away_x_m, y_m + away_y_m))


def test_a_grid_too_large_to_be_a_map_is_refused() -> None:
    with pytest.raises(ValueError, match="too large"):
        GridSettings().spec_covering(((0.0, 0.0), (1000.0, 0.0)), 3.0)


@pytest.mark.parametrize(
    "bad", [{"resolution_m": 0.0}, {"resolution_m": float("nan")}, {"rows": 0}, {"cols": 10**6}, {"raise_alpha": 1.0}]
)
def test_impossible_settings_are_refused_by_name(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        GridSettings(**bad)  # type: ignore[arg-type]  # wrong on purpose
