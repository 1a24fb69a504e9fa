"""A whole daemon on a whole simulated robot, in memory; on a virtual loop it lives in virtual time."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, replace
from pathlib import Path

from robotd.app.compose import Daemon, compose
from robotd.app.daemon import new_journal
from robotd.config import Config
from robotd.contract.events import Event, MissionPhase, MissionProgress
from robotd.contract.missions import Mission
from robotd.contract.requests import Arm, Stop
from robotd.core.broadcast import Subscription
from robotd.recording.preroll import PrerollJournal
from robotd.sim.robot import EmulatedRobot
from robotd.sim.runtime import connectors
from tests.support.places import head_on, unpaced

LEASE_S = 10_000.0


class AtOnce:
    """Computes where it is asked; the virtual loop would do the same in its executor."""

    async def run(self, name: str, function: Callable[..., object], *args: object) -> object:
        return function(*args)


@dataclass(frozen=True, slots=True)
class Living:
    """A daemon that is up, the robot under it, and everything it says."""

    daemon: Daemon
    robot: EmulatedRobot
    journal: PrerollJournal
    events: Subscription[Event]

    async def do(self, mission: Mission) -> tuple[list[Event], MissionProgress]:
        """Carry out a mission and return all that was said, and how it ended."""
        mission_id = self.daemon.control.start(mission, LEASE_S)
        said: list[Event] = []
        async for event in self.events:
            said.append(event)
            if isinstance(event, MissionProgress) and event.mission_id == mission_id and event.is_last:
                return said, event
        raise AssertionError("a subscription never ends")

    async def done(self, mission: Mission) -> list[Event]:
        """Carry out a mission that must succeed."""
        said, end = await self.do(mission)
        assert end.phase is MissionPhase.DONE, end
        return said


@contextlib.asynccontextmanager
async def living(
    directory: Path, robot: EmulatedRobot, config: Config | None = None, *, armed: bool = True
) -> AsyncIterator[Living]:
    """Bring a daemon to life on an emulated robot; whatever it writes goes to a directory."""
    config = in_directory(config or Config(), directory)
    journal = new_journal(config)
    async with connectors(robot) as connects:
        daemon = compose(config, connects, head_on(AtOnce(), config), unpaced(AtOnce()), journal)
        with daemon.control.events.subscribe(depth=1_000_000) as events:
            tasks = [asyncio.create_task(part, name=name) for name, part in daemon.parts().items()]
            try:
                await until_ready(daemon)
                if armed:
                    await daemon.control.perform(Arm())
                yield Living(daemon, robot, journal, events)
            finally:
                await daemon.control.perform(Stop("the test is over"))
                for task in tasks:
                    task.cancel()
                await asyncio.gather(*tasks, return_exceptions=True)


def in_directory(config: Config, directory: Path) -> Config:
    return replace(
        config,
        maps=replace(config.maps, dir=str(directory / "maps")),
        recording=replace(config.recording, dir=str(directory / "recordings")),
    )


async def until_ready(daemon: Daemon) -> None:
    async with asyncio.timeout(10.0):
        with contextlib.ExitStack() as stack:
            changes = {
                device.name: stack.enter_context(device.status_changes.subscribe()) for device in daemon.robot.devices
            }
            while daemon.robot.absent:
                await changes[daemon.robot.absent[0]].get()
