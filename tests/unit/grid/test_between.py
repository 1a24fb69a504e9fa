"""The ground between two beams side by side: seen through where it lies between them, and nowhere else."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.between import APART_MAX_RAD, MARGIN_CELLS, between
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.settings import BetweenBeams, GridSettings
from robotd.grid.tables import NO_INFORMATION

SPEC = GridSpec(0.1, -6.0, -6.0, (120, 120))
UNSEEN = GridSettings(between_beams=BetweenBeams.UNSEEN)


def reading(bearing_rad: float, range_m: float, *, hit: bool = True) -> RangeReading:
    return RangeReading(0, bearing_rad, ReadingStatus.OK if hit else ReadingStatus.MISS, range_m)


@st.composite
def sweeps(draw: st.DrawFn) -> Sweep:
    count = draw(st.integers(2, 300))
    ranges = draw(st.lists(st.floats(0.3, 5.5), min_size=count, max_size=count))
    hits = draw(st.lists(st.booleans(), min_size=count, max_size=count))
    order = draw(st.permutations(range(count)))
    readings = [reading(2 * math.pi * k / 300, ranges[k], hit=hits[k]) for k in range(count)]
    return Sweep(0, IDENTITY, tuple(readings[k] for k in order))


def inserted(sweep: Sweep, settings: GridSettings | None, pose: Pose2 = IDENTITY) -> OccupancyGrid:
    grid = OccupancyGrid(SPEC, settings=settings)
    grid.insert(sweep, pose)
    return grid


def between_by_hand(sweep: Sweep, slack_cells: float) -> NDArray[np.bool_]:
    """Ask each cell whether its middle lies between two beams; ``slack_cells`` nearer or farther is still right."""
    rows, cols = np.indices(SPEC.shape)
    x_m, y_m = (cols + 0.5) * 0.1 - 6.0, (rows + 0.5) * 0.1 - 6.0
    distance_m, bearing_rad = np.hypot(x_m, y_m), np.arctan2(y_m, x_m)
    found = np.zeros(SPEC.shape, np.bool_)
    readings = sorted(sweep.readings, key=lambda one: one.bearing_rad)
    for one, other in zip(readings, [*readings[1:], readings[0]], strict=True):
        apart_rad = (other.bearing_rad - one.bearing_rad) % (2 * math.pi)
        if not 0.0 < apart_rad <= APART_MAX_RAD:
            continue
        reach_m = min(one.range_m or 0.0, other.range_m or 0.0) - MARGIN_CELLS * 0.1
        after_rad = np.mod(bearing_rad - one.bearing_rad + math.pi, 2 * math.pi) - math.pi
        slack_rad = slack_cells * 0.1 / np.maximum(distance_m, 0.05)
        found |= (
            (after_rad >= -slack_rad)
            & (after_rad <= apart_rad + slack_rad)
            & (distance_m <= reach_m + slack_cells * 0.1)
        )
    return found


@given(sweep=sweeps())
@settings(max_examples=60, deadline=None)
def test_what_lies_between_is_seen_and_nothing_else_changes(sweep: Sweep) -> None:
    plain, filled = inserted(sweep, UNSEEN).cells, inserted(sweep, None).cells
    changed = plain != filled
    assert (plain[changed] == NO_INFORMATION).all()
    assert (filled[changed] < NO_INFORMATION).all()
    assert not (changed & ~between_by_hand(sweep, 1.0)).any()
    surely = between_by_hand(sweep, -0.75)
    assert not (surely & (filled == NO_INFORMATION)).any()


def test_a_leg_that_an_earlier_stop_hit_stays() -> None:
    """It stands at 3 m, and beams that pass on both sides of it, a cell away, must not wash it out."""
    grid = OccupancyGrid(SPEC)
    grid.insert(Sweep(0, IDENTITY, (reading(math.atan2(0.05, 3.05), math.hypot(3.05, 0.05)),)), IDENTITY)
    before = grid.cells.copy()
    sides = (reading(math.atan2(-0.02, 3.05), 5.0), reading(math.atan2(0.11, 3.05), 5.0))
    grid.insert(Sweep(1, IDENTITY, sides), IDENTITY)
    row, col = SPEC.cell_at(3.05, 0.05)
    assert before[row, col] > NO_INFORMATION
    assert grid.cells[row, col] == before[row, col]
    assert grid.cells[row, col + 3] < NO_INFORMATION == before[row, col + 3]  # behind it they do fill the ground


def test_a_wall_hit_in_spots_gets_no_gaps() -> None:
    """Beams 2 degrees apart at 5 m hit a wall every 17 cm: between the spots it is unknown, not open."""
    bearings = np.radians(np.arange(-40.0, 41.0, 2.0))
    sweep = Sweep(0, IDENTITY, tuple(reading(b, 5.0 / math.cos(b)) for b in bearings.tolist()))
    cells = inserted(sweep, None).cells
    wall = cells[:, SPEC.cell_at(5.0, 0.0)[1]][SPEC.cell_at(0.0, -3.5)[0] : SPEC.cell_at(0.0, 3.5)[0]]
    assert (wall >= NO_INFORMATION).all()


@pytest.mark.parametrize("apart_deg", [3.0, 90.0, 180.0])
def test_beams_far_apart_say_nothing_of_what_lies_between(apart_deg: float) -> None:
    sweep = Sweep(0, IDENTITY, (reading(0.0, 4.0), reading(math.radians(apart_deg), 4.0)))
    assert len(between(Readings.of(sweep.readings), 0.1)) == 0
    assert inserted(sweep, None).digest() == inserted(sweep, UNSEEN).digest()


def test_the_first_and_the_last_beam_of_a_round_are_side_by_side() -> None:
    found = between(Readings.of((reading(math.radians(359.5), 5.0), reading(math.radians(0.5), 5.0))), 0.05)
    assert len(found) > 1
    assert (np.cos(found.bearing_rad) > 0.999).all()


@given(sweep=sweeps(), x_m=st.floats(-2, 2), heading_rad=st.floats(-3, 3))
@settings(max_examples=20, deadline=None)
def test_the_cells_that_changed_are_told(sweep: Sweep, x_m: float, heading_rad: float) -> None:
    grid = OccupancyGrid(SPEC)
    before = grid.cells.copy()
    changed = grid.insert(sweep, Pose2(x_m, 0.5, heading_rad))
    np.testing.assert_array_equal(changed, np.flatnonzero(before.ravel() != grid.cells.ravel()))
