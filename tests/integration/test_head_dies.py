"""Whatever a daemon is at when its head dies or hangs, it comes to the same, and its replay to the same again."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from robotd.app.compose import compose, head_settings
from robotd.app.daemon import new_journal
from robotd.app.replaying import replay_recording
from robotd.children.channel import Channel, Message, Part
from robotd.children.in_process import InProcess, Main
from robotd.children.process import Running
from robotd.config import Config
from robotd.contract.events import MissionPhase, MissionProgress, Status
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, MapLoad, MapSave, MapShow, RecordStart, RecordStop, Stop
from robotd.core.errors import ChildError, RobotdError
from robotd.head.far import AWAY_S, FarHead
from robotd.head.program import serve
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.recording.entries import CauseEntry
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.living import AtOnce, Living, in_directory, until_ready
from tests.support.places import unpaced

QUICK = replace(Config(), sweep=SweepSettings(readings=60))


@dataclass
class Heads:
    """Heads as the program has them, of which some end, or stand still, before their n-th job."""

    ends_at: frozenset[int] = frozenset()
    """Counted from 0, over all heads."""
    hangs_at: frozenset[int] = frozenset()
    cannot_start_from: int = 10**9
    """From this life on."""
    jobs: int = 0
    lives: int = 0
    hung: list[asyncio.Event] = field(default_factory=list)

    def start(self) -> Running:
        self.lives += 1
        if self.lives > self.cannot_start_from:
            raise ChildError("it cannot be started: no memory")
        return InProcess(self._main())

    def _main(self) -> Main:
        async def main(life: Channel, lanes: Sequence[Channel]) -> None:
            await serve(life, [_Between(lanes[0], self._before_job)])

        return main

    async def _before_job(self) -> None:
        number, self.jobs = self.jobs, self.jobs + 1
        if number in self.ends_at:
            raise SystemError("killed")
        if number in self.hangs_at:
            await asyncio.Event().wait()


@dataclass
class _Between:
    """A lane on which something may happen before a job is received; the first message is no job."""

    lane: Channel
    before_job: Callable[[], Awaitable[None]]
    received: int = 0

    async def receive(self) -> Message:
        message = await self.lane.receive()
        self.received += 1
        if self.received > 1:
            await self.before_job()
        return message

    def send(self, *parts: Part) -> bool:
        return self.lane.send(*parts)

    async def room(self) -> None:
        await self.lane.room()

    def close(self) -> None:
        self.lane.close()


@contextlib.asynccontextmanager
async def living_with(directory: Path, heads: Heads) -> AsyncIterator[Living]:
    config, robot = in_directory(QUICK, directory), SimulatedRobot(load_world("office"), seed=5)
    journal, head = new_journal(config), FarHead(head_settings(config), heads.start, job_s=3.0)
    async with connectors(robot) as connects:
        daemon = compose(config, connects, head, unpaced(AtOnce()), journal)
        head.host = daemon.causes
        await daemon.control.perform(RecordStart(str(directory / "recordings" / "a.mcap")))
        with daemon.control.events.subscribe(depth=1_000_000) as events:
            parts = daemon.parts() | {"head": head.run()}
            tasks = [asyncio.create_task(part, name=name) for name, part in parts.items()]
            try:
                await until_ready(daemon)
                await daemon.control.perform(Arm())
                yield Living(daemon, robot, journal, events)
            finally:
                await daemon.control.perform(Stop("the test is over"))
                await daemon.control.perform(RecordStop())
                for task in tasks:
                    task.cancel()
                await asyncio.gather(*tasks, return_exceptions=True)


async def the_main_job(it: Living) -> list[str]:
    """Map two stops, save, load and show the map, drive, and localize; return why missions were held."""
    control, robot = it.daemon.control, it.robot
    assert isinstance(robot, SimulatedRobot)
    said = await it.done(MapStart.of("office", robot.stops_m[:1], robot.start, Legs.STRAIGHT))
    await control.perform(MapSave())
    here = it.daemon.supervisor.whereabouts.map_in_use
    assert here is not None
    await control.perform(MapLoad.of("office", None, robot.truth))
    shown = await control.perform(MapShow())
    assert (shown.map_id, shown.stops) == (here.digest, 2)
    said += await it.done(DriveTo(robot.start.x_m, robot.start.y_m))
    said += await it.done(Localize())
    return [event.held for event in said if isinstance(event, Status) and event.held is not None]


def same_again(directory: Path) -> None:
    with ThreadPoolExecutor(1) as elsewhere:  # here another loop turns
        report = elsewhere.submit(replay_recording, directory / "recordings" / "a.mcap").result()
    assert report.differences == ()
    assert report.digest == report.recorded_digest


async def test_whatever_a_head_dies_at_the_main_job_is_done_and_its_replay_in_which_none_dies_comes_to_the_same(
    tmp_path: Path,
) -> None:
    heads = Heads(ends_at=frozenset({0, 2, 6, 10, 15, 21}), hangs_at=frozenset({13}))
    async with living_with(tmp_path, heads) as it:
        held = await the_main_job(it)
        assert it.daemon.supervisor.mode is Mode.IDLE
    assert heads.lives == 1 + len(heads.ends_at) + len(heads.hangs_at)
    assert {cause.partition(" (")[2].partition(")")[0] for cause in held} <= {
        "it ended with SystemError('killed'",
        "it was silent for 5 s",
        "a job took more than 3 s",
    }
    assert held
    same_again(tmp_path)


async def test_a_mission_whose_head_does_not_come_back_ends_disarmed_and_so_does_its_replay(tmp_path: Path) -> None:
    heads = Heads(ends_at=frozenset({1}), cannot_start_from=1)
    async with living_with(tmp_path, heads) as it:
        _, end = await it.do(MapStart.of("office", (), it.robot.start))
        assert end.phase == "stopped"
        assert f"has been away for {AWAY_S:g} s: it cannot be started: no memory" in end.message
        assert it.daemon.supervisor.mode is Mode.DISARMED
        (cause,) = [entry for entry in it.journal.remembered if isinstance(entry, CauseEntry) and entry.name == "head"]
        assert cause.arguments["why"] == end.message
        await it.daemon.control.perform(Arm())  # the lines are there, and so is the robot
        with pytest.raises(RobotdError, match="has been away"):
            await it.daemon.control.perform(MapShow())
        _, end = await it.do(Localize())
        assert (end.phase, it.daemon.supervisor.mode) == ("stopped", Mode.DISARMED)
    same_again(tmp_path)


async def test_a_stop_does_not_wait_for_a_head_that_hangs(tmp_path: Path) -> None:
    heads = Heads(hangs_at=frozenset({1}))
    async with living_with(tmp_path, heads) as it:
        control = it.daemon.control
        control.start(MapStart.of("office", (), it.robot.start), 10_000.0)
        async for event in it.events:
            if isinstance(event, MissionProgress) and event.phase is MissionPhase.COMPUTING:
                break
        before_s = asyncio.get_running_loop().time()
        await control.perform(Stop("enough"))
        assert asyncio.get_running_loop().time() - before_s < 0.5
        await asyncio.sleep(2.0)  # what nobody waits for any more was ended with its head
        assert heads.lives == 2
        assert (await control.perform(MapShow())).generation == 0
    same_again(tmp_path)
