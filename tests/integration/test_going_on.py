"""Mapping goes on where it was left: on the map in use, or on one that came from the store."""

from dataclasses import replace
from pathlib import Path

import pytest

from robotd.contract.events import MissionPhase, StopPlaced
from robotd.contract.missions import Localize, MapContinue, MapStart, PriorHeading
from robotd.contract.requests import MapLoad, MapSave, RecordStart, RecordStop
from robotd.sim.buildings.world import Start, load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.replayed import check, replayed

pytestmark = pytest.mark.slow


async def test_it_goes_on_with_the_map_in_use_and_the_replay_does_the_same(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"))
    async with live(robot) as it:
        control = it.daemon.control
        recording = await control.perform(RecordStart())
        await it.done(MapStart.of("office", robot.stops_m[:1], robot.start))
        said = await it.done(MapContinue.of("office", robot.stops_m[1:2]))
        placed = [event for event in said if isinstance(event, StopPlaced)]
        assert [(event.stop, event.outcome) for event in placed] == [(2, "placed"), (3, "placed")]
        assert placed[-1].pose.distance_m(robot.truth) < 0.1
        place = it.daemon.supervisor.whereabouts.map_in_use
        assert place is not None
        assert (place.name, place.stops, place.is_unsaved) == ("office", 4, True)
        await control.perform(RecordStop())
    assert recording.path is not None
    check(replayed(Path(recording.path)))


async def test_a_stored_map_is_gone_on_with_once_the_robot_is_found_on_it(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"))
    async with live(robot) as it:
        await it.done(MapStart.of("office", robot.stops_m[:1], robot.start))
        await it.daemon.control.perform(MapSave())
    stood = robot.truth
    again = SimulatedRobot(replace(load_world("office"), start=Start(stood.x_m, stood.y_m, stood.heading_rad)), 2)
    async with live(again) as it:
        control = it.daemon.control
        await control.perform(MapLoad("office"))
        _, end = await it.do(MapContinue.of("office", robot.stops_m[1:2]))
        assert end.phase is MissionPhase.FAILED
        assert "not localized on this map; first: robotctl localize, then map continue" in end.message
        await it.done(Localize(heading=PriorHeading.UNKNOWN))
        said = await it.done(MapContinue.of("office", robot.stops_m[1:2]))
        placed = [event for event in said if isinstance(event, StopPlaced)]
        assert [event.stop for event in placed] == [2, 3]
        assert placed[-1].pose.distance_m(again.truth) < 0.1
        entry = await control.perform(MapSave())
        assert (entry.version, entry.stops) == (2, 4)


async def test_who_knows_where_it_stands_need_not_have_it_found(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"))
    async with live(robot) as it:
        await it.done(MapStart.of("office", (), robot.start))
        await it.daemon.control.perform(MapSave())
        await it.daemon.control.perform(MapLoad("office"))  # nothing ties it to odometry
        said = await it.done(MapContinue.of("office", (), robot.truth))
        (placed,) = [event for event in said if isinstance(event, StopPlaced)]
        assert (placed.stop, placed.outcome) == (1, "placed")
        assert placed.pose.distance_m(robot.truth) < 0.05


async def test_another_map_than_the_one_named_is_left_alone(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"))
    async with live(robot) as it:
        await it.done(MapStart.of("office", (), robot.start))
        _, end = await it.do(MapContinue.of("kitchen"))
        assert end.phase is MissionPhase.FAILED
        assert "the map in use is office, not kitchen" in end.message
