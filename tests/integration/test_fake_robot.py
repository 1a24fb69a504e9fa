"""Hardware in the loop, in memory: a fresh daemon on the fake of a recorded robot makes the same map."""

import asyncio
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from robotd.config import Config
from robotd.contract.events import SweepDone
from robotd.contract.missions import Legs, Localize, MapStart
from robotd.contract.requests import Arm, RecordStart, RecordStop
from robotd.core.reading import Sweep
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.recording.reader import Recording, read
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import OWN
from robotd.sim.fakes.fake_robot import FakeRobot
from robotd.sim.robot import DEVICES, SimulatedRobot

pytestmark = pytest.mark.slow

STOPS_M = ((1.6, 0.9), (1.2, 1.4))
QUICK = replace(Config(), sweep=SweepSettings(readings=24))


def sweeps(said: list[Any]) -> list[Sweep]:
    return [event.sweep for event in said if isinstance(event, SweepDone)]


def timeless(sweep: Sweep) -> Sweep:
    return replace(sweep, readings=tuple(replace(reading, time_ns=0) for reading in sweep.readings))


async def record(live: Any, path: Path) -> tuple[str, list[Sweep]]:
    """Map two stops of the office and localize; return the map's digest and the sweeps."""
    robot = SimulatedRobot(load_world("office"), seed=5)
    async with live(robot, QUICK) as it:
        await it.daemon.control.perform(RecordStart(str(path)))
        said = await it.done(MapStart.of("office", STOPS_M, robot.start, Legs.STRAIGHT))
        digest = it.daemon.supervisor.whereabouts.map_in_use.digest
        said += await it.done(Localize())
        await it.daemon.control.perform(RecordStop())
    assert len(sweeps(said)) == 1 + len(STOPS_M) + 1
    return digest, sweeps(said)


async def repeat(live: Any, recording: Recording, *, dawdle_s: float) -> tuple[str, list[Sweep], FakeRobot]:
    """Do the same on the fake, but wait between what is asked."""
    fake = FakeRobot(recording, dict.fromkeys(DEVICES, OWN))
    robot = SimulatedRobot(load_world("office"), seed=5)
    async with live(fake, QUICK, armed=False) as it:
        await asyncio.sleep(dawdle_s)
        await it.daemon.control.perform(Arm())
        await asyncio.sleep(dawdle_s)
        said = await it.done(MapStart.of("office", STOPS_M, robot.start, Legs.STRAIGHT))
        digest = it.daemon.supervisor.whereabouts.map_in_use.digest
        await asyncio.sleep(dawdle_s)
        said += await it.done(Localize())
        mismatches = fake.mismatches
    assert mismatches == ()
    return digest, sweeps(said), fake


@pytest.mark.parametrize("dawdle_s", [0.0, 0.037, 61.0])
async def test_a_fresh_daemon_on_the_fake_makes_the_same_map(live: Any, tmp_path: Path, dawdle_s: float) -> None:
    digest, recorded = await record(live, tmp_path / "recordings" / "a.mcap")
    again, repeated, fake = await repeat(live, read(tmp_path / "recordings" / "a.mcap"), dawdle_s=dawdle_s)
    assert [timeless(sweep) for sweep in repeated] == [timeless(sweep) for sweep in recorded]
    assert again == digest
    assert fake.finished
