"""Recordings that begin late, and missions that end early, replay like any other."""

import asyncio
from pathlib import Path

import pytest

from robotd.contract.events import MissionPhase
from robotd.contract.missions import Localize, MapStart
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, MapLoad, MapSave, RecordStart, RecordStop, Stop
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import Living
from tests.support.replayed import check, replayed

pytestmark = pytest.mark.slow


async def test_a_recording_started_late_begins_where_the_daemon_began(live: Live, tmp_path: Path) -> None:
    robot = SimulatedRobot(load_world("office"), seed=4)
    async with live(robot) as it:
        await it.done(MapStart.of("office", (), robot.start))
        await it.daemon.control.perform(RecordStart(str(tmp_path / "recordings" / "late.mcap")))
        await it.done(Localize())
        await it.daemon.control.perform(RecordStop())
    check(replayed(tmp_path / "recordings" / "late.mcap"))


@pytest.mark.parametrize("after_s", [0.5, 4.3, 7.0])
async def test_a_mission_stopped_in_the_middle_replays(live: Live, tmp_path: Path, after_s: float) -> None:
    robot = SimulatedRobot(load_world("office"), seed=4)
    async with live(robot, armed=False) as it:
        await it.daemon.control.perform(RecordStart(str(tmp_path / "recordings" / "stopped.mcap")))
        await it.daemon.control.perform(Arm())
        it.daemon.control.start(MapStart.of("office", robot.stops_m, robot.start), 1000.0)
        await asyncio.sleep(after_s)
        await it.daemon.control.perform(Stop("enough"))
        await asyncio.sleep(1.0)
        assert it.daemon.supervisor.mode is Mode.DISARMED
        await it.daemon.control.perform(RecordStop())
    check(replayed(tmp_path / "recordings" / "stopped.mcap"))


async def test_a_lease_that_runs_out_stops_the_robot_and_replays(live: Live, tmp_path: Path) -> None:
    robot = SimulatedRobot(load_world("office"), seed=4)
    async with live(robot, armed=False) as it:
        await it.daemon.control.perform(RecordStart(str(tmp_path / "recordings" / "lease.mcap")))
        await it.daemon.control.perform(Arm())
        mission_id = it.daemon.control.start(MapStart.of("office", robot.stops_m, robot.start), 0.5)
        for _ in range(10):
            await asyncio.sleep(0.4)
            it.daemon.control.renew(mission_id)
        assert mode_of(it) == "mapping"
        await asyncio.sleep(1.0)
        assert mode_of(it) is Mode.DISARMED
        assert "lease" in it.daemon.control.status.reason
        assert not any(device.armed for device in it.daemon.control.status.devices)
        await it.daemon.control.perform(RecordStop())
    check(replayed(tmp_path / "recordings" / "lease.mcap"))


def mode_of(it: Living) -> str:
    return it.daemon.control.status.mode


async def test_a_map_taken_into_use_is_in_the_recording(live: Live, tmp_path: Path) -> None:
    robot = SimulatedRobot(load_world("office"), seed=4)
    async with live(robot) as it:
        await it.done(MapStart.of("office", robot.stops_m[:2], robot.start))
        await it.daemon.control.perform(MapSave("kept"))
    again = SimulatedRobot(load_world("office"), seed=5)
    async with live(again, armed=False) as it:
        await it.daemon.control.perform(RecordStart(str(tmp_path / "recordings" / "loaded.mcap")))
        await it.daemon.control.perform(Arm())
        await asyncio.sleep(0.1)  # odometry comes with the telemetry
        await it.daemon.control.perform(MapLoad.of("kept", None, again.start))
        end = (await it.do(Localize()))[1]
        assert end.phase is MissionPhase.DONE
        await it.daemon.control.perform(RecordStop())
    (tmp_path / "maps").rename(tmp_path / "maps moved away")
    check(replayed(tmp_path / "recordings" / "loaded.mcap"))
