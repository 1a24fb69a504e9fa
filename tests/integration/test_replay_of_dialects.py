"""A recording of a robot of bought devices replays to what was recorded, too: nothing in them goes by timers alone."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from robotd.app.replaying import replay_recording
from robotd.cli.emulated import config_text
from robotd.config import loads
from robotd.contract.missions import LocalizeMission, MapMission
from robotd.core.clock import run_virtual
from robotd.mission.stop_and_sweep import SweepSettings
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.robot import DEVICES, SimulatedRobot
from robotd.sim.world import load_world

pytestmark = pytest.mark.slow

ROBOTS = (
    Dialects("rwi-ascii", "ptu", "dimetix"),
    Dialects("rflex", "dynamixel", "tfmini-s"),
    Dialects("board", "fixed", "scip"),
    Dialects("board", "board", "lw20"),
    Dialects("board", "board", "lwnx"),
    Dialects("board", "board", "disto"),
)


async def record(live: Any, path: Path, dialects: Dialects) -> None:
    world = load_world("office")
    text = config_text({device: f"/dev/emulated/{device}" for device in DEVICES}, dialects.settings())
    config = replace(loads(text), sweep=SweepSettings(readings=24))
    async with live(SimulatedRobot(world, seed=5, dialects=dialects), config) as it:
        await it.daemon.control.start_recording(str(path))
        await it.done(MapMission("office", world.stops_m[:1], world.start_pose))
        await it.done(LocalizeMission())
        await it.daemon.control.stop_recording()


@pytest.mark.parametrize("dialects", ROBOTS, ids=lambda robot: f"{robot.drive}-{robot.pantilt}-{robot.rangefinder}")
def test_a_replay_comes_to_what_was_recorded(live: Any, tmp_path: Path, dialects: Dialects) -> None:
    run_virtual(record(live, tmp_path / "recordings" / "a.mcap", dialects))
    report = replay_recording(tmp_path / "recordings" / "a.mcap")
    assert report.differences == ()
    assert report.digest == report.recorded_digest
    assert report.results > 3
