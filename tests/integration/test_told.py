"""What clients need to draw it all: where odometry and sweeps lie on the map, readings as they come, plans and ways."""

import math
import zlib
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from robotd.config import Config
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import (
    Event,
    MapChanged,
    MissionPhase,
    MissionProgress,
    RankMap,
    SweepBegun,
    SweepDone,
    SweepReadings,
)
from robotd.contract.missions import DriveTo, Localize, MapStart, PriorHeading, Scan, with_lease
from robotd.contract.requests import MapLoad, MapSave, PlanTo
from robotd.contract.sweep_columns import from_columns
from robotd.contract.topics import Topic
from robotd.contract.ways import Hindrance, MissionPlan, StopState
from robotd.core.pose import Odometry, Pose2
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live

pytestmark = pytest.mark.slow

QUICK = replace(Config(), sweep=SweepSettings(readings=120))
NOWHERE = (-3.0, -3.0)


def office() -> SimulatedRobot:
    return SimulatedRobot(load_world("office"), seed=5)


def near(one: Pose2, other: Pose2) -> bool:
    return one.distance_m(other) < 1e-9 and abs(one.heading_rad - other.heading_rad) < 1e-9


async def test_odometry_and_sweeps_can_be_drawn_on_the_map_by_what_is_told(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        said = await it.done(MapStart.of("office", robot.stops_m[:1], robot.start))
        said += await it.done(Localize())
        said += await it.done(DriveTo(*robot.stops_m[0]))
    tie: Pose2 | None = None
    drawn = []
    for event in said:
        match event:
            case PoseEstimate():
                tie = event.map_from_odom
                if event.final and event.best is not None and event.in_odom is not None and tie is not None:
                    assert near(tie @ event.in_odom, event.best)
            case Odometry() if tie is not None:
                drawn.append(tie @ event.in_odom)
            case SweepBegun() | SweepDone():
                in_odom = event.in_odom if isinstance(event, SweepBegun) else event.sweep.in_odom
                assert event.in_map is not None
                assert tie is not None
                assert near(event.in_map, tie @ in_odom)
    # What is drawn goes on without a jump: a tie that changes is told with the pose that it leads to.
    assert max(after.distance_m(before) for before, after in pairwise(drawn)) < 0.1
    assert drawn[-1].distance_m(robot.truth) < 0.1


async def test_nothing_ties_odometry_to_a_map_on_which_the_robot_was_not_found_yet(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        await it.done(MapStart.of("office", robot.stops_m[:1], robot.start))
        await it.daemon.control.perform(MapSave())
        await it.daemon.control.perform(MapLoad.of("office"))
        way = await it.daemon.control.perform(PlanTo(1.0, 1.0))
        assert (way.reason, way.waypoints_m) == (Hindrance.NOT_LOCALIZED, ())
        said = await it.done(Localize(heading=PriorHeading.UNKNOWN))
    begun = [event for event in said if isinstance(event, SweepBegun)]
    assert [event.in_map for event in begun] == [None]
    estimates = [event for event in said if isinstance(event, PoseEstimate) and event.readings]
    assert [event.map_from_odom for event in estimates if not event.final] == [None, None, None, None]
    (last,) = [event for event in estimates if event.final]
    assert last.state is PoseState.LOCALIZED
    assert last.map_from_odom is not None
    assert last.in_odom == begun[0].in_odom
    missions = [event.mission_id for event in said if isinstance(event, MissionProgress)]
    assert {(event.mission_id, event.sweep) for event in estimates} == {(missions[-1], begun[0].number)}


async def test_the_columns_of_a_sweep_are_its_readings(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        said = await it.done(MapStart.of("office", (), robot.start))
    (done,) = [event for event in said if isinstance(event, SweepDone)]
    told = [reading for event in said if isinstance(event, SweepReadings) for reading in from_columns(event)]
    for one, other in zip(told, done.sweep.readings, strict=True):
        assert one.status is other.status
        assert one.bearing_rad == pytest.approx(other.bearing_rad, abs=1e-6)
        assert (one.range_m or 0.0) == pytest.approx(other.range_m or 0.0, abs=1e-6)


def states(event: MissionPlan) -> list[StopState]:
    return [stop.state for stop in event.stops]


def plans(said: list[Event]) -> list[MissionPlan]:
    return [event for event in said if isinstance(event, MissionPlan)]


async def test_the_plan_of_a_map_says_what_became_of_each_stop_and_the_way_to_it(live: Live) -> None:
    robot = office()
    stop_m = robot.stops_m[0]
    async with live(robot, QUICK) as it:
        said = await it.done(MapStart.of("office", (NOWHERE, stop_m), robot.start))
        way = await it.daemon.control.perform(PlanTo(*NOWHERE))
    told = plans(said)
    waiting, under_way, swept, unreached = StopState
    assert [states(event) for event in told] == [
        [under_way, waiting, waiting],
        [swept, waiting, waiting],
        [swept, under_way, waiting],
        [swept, unreached, waiting],
        [swept, unreached, under_way],
        [swept, unreached, under_way],
        [swept, unreached, swept],
    ]
    assert [(event.start_m, event.goal_m) for event in told[:5]] == [(None, None)] * 5
    assert told[5].waypoints_m[-1] == told[5].goal_m == stop_m
    missed = told[-1].stops[1]
    assert missed.reason is not None
    # From elsewhere since, and on a map that has grown: asked again, the answer is of the same kind.
    assert way.reason is missed.reason
    assert way.nearest_m is not None
    assert missed.nearest_m is not None
    at = [index for index, event in enumerate(said) if isinstance(event, MapChanged) and not event.whole]
    assert [states(told[1]), states(told[6])] == [states(plans(said[index:])[0]) for index in at]


async def test_a_way_that_is_asked_for_is_the_way_that_is_driven(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        await it.done(MapStart.of("office", robot.stops_m[:1], robot.start))
        goal_m = (robot.start.x_m, robot.start.y_m)
        noted = len(tuple(it.journal.remembered))
        way = await it.daemon.control.perform(PlanTo(*goal_m))
        assert [type(entry).__name__ for entry in tuple(it.journal.remembered)[noted:]] == []
        said, end = await it.do(DriveTo(*goal_m))
    assert end.phase is MissionPhase.DONE
    (plan,) = plans(said)
    assert plan.waypoints_m == way.waypoints_m
    assert plan.start_m is not None
    assert way.length_m == pytest.approx(sum(math.dist(*leg) for leg in pairwise((plan.start_m, *way.waypoints_m))))
    assert (plan.mission_id, plan.stops) == (end.mission_id, ())


async def test_the_status_says_whose_mission_is_under_way(live: Live) -> None:
    async with live(office(), QUICK) as it:
        before = it.daemon.control.status
        await it.daemon.control.perform(with_lease(Scan(), 5.0), "anna")
        meanwhile = it.daemon.control.status
        while not (isinstance(event := await it.events.get(), MissionProgress) and event.is_last):
            pass
        after = it.daemon.control.status
    assert (before.commander, after.commander) == (None, None)
    assert meanwhile.commander is not None
    assert (meanwhile.commander.client, meanwhile.commander.kind) == ("anna", "scan")
    assert (meanwhile.commander.since_ns, meanwhile.commander.lease_s) == (meanwhile.since_ns, 5.0)


@pytest.mark.parametrize("heading", PriorHeading)
async def test_the_heat_map_is_told_each_quarter_and_at_the_end_while_somebody_looks(
    live: Live, heading: PriorHeading
) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        said = await it.done(MapStart.of("office", robot.stops_m[:1], robot.start))
        assert not any(isinstance(event, RankMap) for event in said)
        it.daemon.control.watch(frozenset({Topic.RANK}))
        said = await it.done(Localize(heading=heading))
        shown = [event for event in said if isinstance(event, RankMap)]
        it.daemon.control.watch(frozenset())
        said += await it.done(Localize(heading=heading))
    assert shown == [event for event in said if isinstance(event, RankMap)]
    (last,) = [event for event in said[: said.index(shown[-1])] if isinstance(event, PoseEstimate) and event.final][-1:]
    assert [event.readings for event in shown] == sorted(event.readings for event in shown)
    assert (len(shown), shown[-1].readings, shown[-1].reduce) == (4, last.readings, 1)
    (sweep,) = {event.number for event in shown}
    assert sweep == next(event.sweep.number for event in said if isinstance(event, SweepDone))
    levels = np.frombuffer(zlib.decompress(shown[-1].levels_zlib), np.uint8).reshape(shown[-1].rows, shown[-1].cols)
    assert levels.max() == last.best_rank * 255 // last.readings
    assert last.best is not None
    row, col = np.unravel_index(levels.argmax(), levels.shape)
    place_m = np.array([shown[-1].origin_x_m, shown[-1].origin_y_m]) + shown[-1].resolution_m * np.array([col, row])
    assert math.dist(place_m, (last.best.x_m, last.best.y_m)) < 0.3
