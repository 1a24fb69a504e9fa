"""The map in use is replaced, never changed under whoever holds it; predictions follow odometry on it."""

import math

import numpy as np
import pytest

from robotd.contract.estimate import PoseState
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import GridSettings, OccupancyGrid
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.mission.whereabouts.prediction import Predictor, unlocalized


def place(map_from_odom: Pose2 | None = IDENTITY) -> MapInUse:
    grid = OccupancyGrid(GridSettings(rows=60, cols=60).spec_covering(((0.0, 0.0),), 1.0))
    return MapInUse("m", "office", grid, map_from_odom)


def sweep_at(in_odom: Pose2) -> Sweep:
    readings = (RangeReading(number, number * 0.2, ReadingStatus.OK, 1.0) for number in range(30))
    return Sweep(0, in_odom, tuple(readings))


def at(x_m: float, y_m: float = 0.0, heading_rad: float = 0.0) -> Odometry:
    return Odometry(5, Pose2(x_m, y_m, heading_rad), STANDSTILL)


def test_a_sweep_makes_a_new_grid_and_leaves_every_snapshot_alone() -> None:
    here = place()
    before, snapshot = here.grid, here.whole(1)
    laid = here.grid_with(sweep_at(IDENTITY))
    assert here.grid is before
    assert np.all(before.cells == before.cells[0, 0])
    here.take(laid)
    assert here.grid is laid.grid
    assert here.digest == laid.grid.digest() != before.digest()
    assert here.generation == 1
    assert np.all(snapshot.values == before.cells)
    change = here.changes(2, laid.cells)
    patched = snapshot.values.copy()
    patched.reshape(-1)[change.cells] = change.values
    assert np.array_equal(patched, here.whole(3).values)
    assert (snapshot.generation, change.generation) == (0, 1)


def test_a_map_is_made_of_the_stops_that_were_laid_in_and_no_snapshot_of_them_changes() -> None:
    here = place(Pose2(0.5, 0.25, 0.3))
    here.stops = before = MapStops(here.grid.settings)
    for x_m in (0.0, 0.1):
        here.take(here.grid_with(sweep_at(Pose2(x_m, 0.0, 0.0))))
    assert here.stops is not None
    assert before.stops == ()
    assert [stop.map_from_robot for stop in here.stops.stops] == [
        Pose2(0.5, 0.25, 0.3) @ Pose2(x_m, 0.0, 0.0) for x_m in (0.0, 0.1)
    ]
    assert here.stops.grid_on(here.grid.spec).digest() == here.digest


def test_a_map_whose_stops_are_not_known_does_not_get_to_know_them() -> None:
    here = place()
    here.take(here.grid_with(sweep_at(IDENTITY)))
    assert here.stops is None


def test_a_sweep_needs_to_know_where_it_was_taken() -> None:
    with pytest.raises(ValueError, match="not tied to the map"):
        place(None).grid_with(sweep_at(IDENTITY))


def test_a_tie_puts_the_robot_where_it_is_said_to_be_and_carries_it_on() -> None:
    here = place(None)
    assert here.pose_of(at(1.0)) is None
    here.tie(Pose2(2.0, 3.0, math.pi / 2), at(1.0).in_odom)
    assert here.pose_of(at(1.0)) == Pose2(2.0, 3.0, math.pi / 2)
    moved = here.pose_of(at(1.5))
    assert moved is not None
    assert (moved.x_m, moved.y_m) == pytest.approx((2.0, 3.5))


def test_a_pose_is_predicted_when_the_robot_has_moved_or_turned_far_enough_to_matter() -> None:
    here, predictor = place(), Predictor()
    poses = (
        at(0.0),
        at(0.01),
        at(0.03),
        at(0.03, heading_rad=0.01),
        at(0.03, heading_rad=0.03),
        at(0.03, heading_rad=6.31),
    )
    said = [predictor.predict(odometry, here) for odometry in poses]
    assert [estimate is not None for estimate in said] == [True, False, True, False, True, False]
    last = said[4]
    assert last is not None
    assert (last.state, last.best, last.time_ns, last.map_id) == (PoseState.PREDICTED, Pose2(0.03, 0.0, 0.03), 5, "m")
    assert predictor.predict(at(9.0), place(None)) is None


def test_not_to_know_is_said_and_not_left_to_silence() -> None:
    estimate = unlocalized(3, "m")
    assert (estimate.state, estimate.best, estimate.regions) == (PoseState.LOST, None, ())
