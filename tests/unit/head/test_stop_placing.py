"""A stop placed on a map that is held: laid in, held back, or the whole map made again."""

import math
from dataclasses import replace

import numpy as np
import pytest

from robotd.core.errors import MissionError
from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.latest import latest_with
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.settings import GridSettings
from robotd.head.decided import stop_laid
from robotd.head.held import Held
from robotd.head.stop_placing import MapWithStop, with_stop
from robotd.localization.settings import LocalizationSettings
from robotd.slam.local_map import LocalMaps
from robotd.slam.survey import Decision, Reconciled, Survey
from tests.support.surveyed_room import SPEC, odometry_of, room, sweep_at, way_round

GRID, WALLS, POSES = GridSettings(), room(), way_round()[:5]


def as_sweep(number: int, readings: Readings) -> Sweep:
    rows = [(row[0], row[1], ReadingStatus.MISS if row[4] else ReadingStatus.OK) for row in readings.rows.tolist()]
    return Sweep(number, POSES[0], tuple(RangeReading(0, bearing, status, far_m) for bearing, far_m, status in rows))


def surveyed(stops: int) -> list[MapWithStop]:
    """Return the generations of a map that the first stops round the room make."""
    random = np.random.default_rng(4)
    travels = [Travel(), *odometry_of(POSES, random)]
    held, made = Held.of(OccupancyGrid(SPEC, settings=GRID), MapStops(GRID)), []
    for stop in range(stops):
        sweep = as_sweep(stop, sweep_at(WALLS, POSES[stop], random))
        made.append(with_stop(held, sweep, travels[stop], POSES[0], LocalizationSettings()))
        held = made[-1].held
    return made


def test_each_stop_is_laid_in_where_it_was_placed() -> None:
    made = surveyed(4)
    assert made[0].map_from_robot == POSES[0]
    assert max(one.map_from_robot.distance_m(pose) for one, pose in zip(made, POSES, strict=False)) < 0.05
    held = made[-1].held
    assert held.stops is not None
    assert [stop.map_from_robot for stop in held.stops.stops] == [one.map_from_robot for one in made]
    assert held.stops.grid_on(SPEC).digest() == held.digest
    told = stop_laid(made[-1], 7, "m")
    assert (told.placed.stop, told.placed.outcome, told.stops, told.reconciled) == (3, "placed", 4, None)
    assert told.decided == (told.placed,)
    assert np.frombuffer(told.cells, "<i8").tolist() == made[-1].cells.tolist()


def test_what_contradicts_the_map_is_not_laid_into_it() -> None:
    before = surveyed(4)[-1].held
    bearings = np.arange(300) * math.tau / 300
    box = Readings(np.column_stack((bearings, np.full(300, 1.2), *np.zeros((3, 300)))))
    made = with_stop(before, as_sweep(9, box), Travel(), POSES[0], LocalizationSettings())
    told = stop_laid(made, 7, "m")
    assert told.placed.outcome == "contradicts"
    assert (told.cells, told.values, told.digest, told.stops) == (b"", b"", before.digest, 4)
    assert made.held.survey is not None
    assert len(made.held.survey.graph.stops) == 5  # kept all the same: it may be placed later


class Moving(Survey):
    """A survey that brings all stops together at the next one, and moves them."""

    def stepped(self, readings: Readings, travel: Travel) -> tuple[Survey, tuple[Decision, ...]]:
        after, decisions = super().stepped(readings, travel)
        moves = np.linspace(0.0, 0.2, len(after.graph.poses))[:, None] * (1.0, -0.5, 0.1)
        moved, told = after.moved_to(after.graph.poses + moves)
        return moved, (*decisions, told)


def test_a_map_whose_stops_moved_is_made_again_of_them() -> None:
    before = surveyed(3)[-1].held
    assert before.survey is not None
    survey = Moving(**{name: getattr(before.survey, name) for name in Survey.__dataclass_fields__})
    random = np.random.default_rng(9)
    sweep = as_sweep(3, sweep_at(WALLS, POSES[3], random))
    travel = odometry_of(POSES[2:4], random)[0]
    made = with_stop(replace(before, survey=survey), sweep, travel, POSES[0], LocalizationSettings())
    held, told = made.held, stop_laid(made, 7, "m")
    assert held.stops is not None
    assert held.survey is not None
    poses = [stop.map_from_robot for stop in held.stops.stops]
    assert poses == [held.survey.graph.pose(stop) for stop in range(4)]
    assert held.stops.grid_on(SPEC).digest() == held.digest == told.digest
    assert made.cells.tolist() == np.flatnonzero(held.grid.cells != before.grid.cells).tolist()
    assert made.map_from_robot == poses[-1] == told.map_from_robot
    latest = np.zeros_like(held.latest)
    for stop in held.stops.stops:
        latest = latest_with(latest, held.grid.usable(stop.sweep), stop.map_from_robot, SPEC)
    assert np.array_equal(held.latest, latest)
    assert told.reconciled is not None
    assert told.reconciled.stops_moved == 3
    assert told.reconciled.largest_move_m == pytest.approx(math.hypot(0.2, 0.1))
    assert any(isinstance(decision, Reconciled) for decision in made.decisions)


@pytest.mark.parametrize("resolution_m", [0.005, 0.05, 0.2])
def test_local_maps_have_the_cells_of_the_map_and_no_more_than_they_can_bear(resolution_m: float) -> None:
    maps = LocalMaps.of(GridSettings(resolution_m=resolution_m), LocalizationSettings())
    assert maps.grid.resolution_m == resolution_m
    assert 2.0 * maps.reach_m / resolution_m <= 2000.0
    assert maps.reach_m == pytest.approx(min(20.0, 1000.0 * resolution_m))
    assert isinstance(
        maps.ground(
            Survey.begun(sweep_at(WALLS, POSES[0], np.random.default_rng(1))).graph, [0], Pose2(0.0, 0.0, 0.0)
        ).grid,
        OccupancyGrid,
    )


def test_a_stored_map_is_gone_on_with_from_where_the_robot_was_found() -> None:
    stored = replace(surveyed(4)[-1].held, survey=None)
    there = POSES[1] @ Pose2(0.3, 0.1, 0.2)
    sweep = as_sweep(9, sweep_at(WALLS, there, np.random.default_rng(7)))
    believed = there @ Pose2(0.03, -0.02, 0.01)
    made = with_stop(stored, sweep, Travel(), believed, LocalizationSettings(), found_again=True)
    assert made.map_from_robot.distance_m(there) < 0.7 * believed.distance_m(there)
    assert made.held.survey is not None
    assert (made.held.survey.stored, len(made.held.survey.graph.stops)) == (4, 5)
    assert made.held.stops is not None
    assert stored.stops is not None
    assert made.held.stops.stops[:4] == stored.stops.stops
    again, _ = made.held.survey.reconciled()
    assert np.abs(again.graph.poses[:4] - made.held.survey.graph.poses[:4]).max() < 0.02


def test_a_map_without_its_stops_is_not_gone_on_with() -> None:
    bare = replace(surveyed(1)[-1].held, survey=None, stops=None)
    sweep = as_sweep(9, sweep_at(WALLS, POSES[0], np.random.default_rng(7)))
    with pytest.raises(MissionError, match="without its stops"):
        with_stop(bare, sweep, Travel(), POSES[0], LocalizationSettings(), found_again=True)
