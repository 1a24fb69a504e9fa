"""The disk is full after stop 17: exploring goes on, says so, and nothing that was kept is lost."""

import asyncio
import errno
from pathlib import Path

import msgspec
import pytest

from robotd.config import Config
from robotd.contract.area import Bounds
from robotd.contract.events import MissionPhase, MissionProgress, StopPlaced
from robotd.contract.missions import Explore
from robotd.contract.requests import MapLoad
from robotd.maps import atomic
from robotd.maps.store import MapStore
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.mission.motion.legs import next_odometry
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.integration.test_keeping import keeping

pytestmark = pytest.mark.slow

COARSE = Config(sweep=SweepSettings(readings=24))
OFFICE = Bounds(0.0, 0.0, 4.0, 4.3)
FULL_AFTER, STOPS = 17, 19


async def test_what_was_kept_before_the_disk_was_full_is_gone_on_with(
    live: Live, caplog: pytest.LogCaptureFixture, tmp_path: Path
) -> None:
    robot = SimulatedRobot(load_world("office"), 1)
    here_again = ((robot.start.x_m, robot.start.y_m),) * (STOPS - 1)
    with pytest.MonkeyPatch.context() as disk:
        async with live(robot, COARSE) as it, keeping(it):
            mission_id = it.daemon.control.start(
                Explore.of("office", robot.start, within=OFFICE, stops_m=here_again, stops_max=STOPS), 1e5
            )
            async for event in it.events:
                if isinstance(event, StopPlaced) and event.stop == FULL_AFTER:
                    disk.setattr(atomic, "write_synced", refuse)
                if isinstance(event, MissionProgress) and event.mission_id == mission_id and event.is_last:
                    assert event.phase is MissionPhase.DONE
                    break
            place = it.daemon.supervisor.whereabouts.map_in_use
            assert place is not None
            assert place.stops == STOPS
            await asyncio.sleep(1.0)
            logged = {line.getMessage() for line in caplog.records if "memory alone" in line.getMessage()}
            assert logged == {
                "the unsaved map office is in memory alone: cannot save map office: No space left on device"
            }
            assert (it.daemon.control.status.map_unsaved, it.daemon.control.status.map_kept_version) == (True, None)
            stored = MapStore(tmp_path / "maps").load("office")
            assert (stored.entry.stops, stored.entry.is_unsaved) == (FULL_AFTER, True)
            assert not list((tmp_path / "maps").glob(".tmp-*"))
        # Killed there, and started again.
    async with live(robot, COARSE) as it, keeping(it):
        await next_odometry(it.daemon.robot.drive, 1.0)
        await it.daemon.control.perform(MapLoad.of("office", None, robot.truth))
        said = await it.done(Explore.of("office", resume=True, stops_max=1))
        assert [event.stop for event in said if isinstance(event, StopPlaced)] == [FULL_AFTER]
        await asyncio.sleep(1.0)
        assert MapStore(tmp_path / "maps").load("office").entry.stops == FULL_AFTER + 1
        place = it.daemon.supervisor.whereabouts.map_in_use
        assert place is not None
        assert place.errand is not None
        # The bounds that it was given, and what it was asked for and had not come to.
        assert place.errand.within == msgspec.structs.astuple(OFFICE)
        assert len(place.errand.asked_m) == STOPS - FULL_AFTER


def refuse(*_: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")
