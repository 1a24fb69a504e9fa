"""A whole daemon in memory, on cables on which everything can go wrong, and a client that holds on to it."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from robotd.app.compose import Daemon, compose
from robotd.app.daemon import new_journal
from robotd.app.stalls import keep_going
from robotd.cli.emulated import config_text
from robotd.config import loads
from robotd.contract.events import Event
from robotd.contract.missions import Mission
from robotd.contract.modes import Mode
from robotd.contract.requests import RecordStart, RecordStop, Stop
from robotd.core.broadcast import Subscription
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError
from robotd.hardware.link.tap import Direction
from robotd.hardware.wire.board import STOP_BYTES
from robotd.head.compute import Compute
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.recording.entries import BytesEntry, Entry
from robotd.recording.preroll import PrerollJournal
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.faults.cable import Cable
from robotd.sim.faults.laid import cables
from robotd.sim.robot import DEVICES, SimulatedRobot
from tests.support.living import AtOnce, in_directory, until_ready
from tests.support.places import head_on, unpaced

LEASE_S = 0.5
_RENEW_S = 0.2
_LOOK_S = 0.005
_PREROLL_BYTES = 64 * 1024


class StopWatch:
    """Notes when a stop was put on a wire, and passes everything on to the journal."""

    def __init__(self, journal: PrerollJournal, daemon: Daemon) -> None:
        self.stops_ns: list[int] = []
        self._stop_of = {device.name: getattr(device, "STOP", STOP_BYTES) for device in daemon.robot.devices}
        self._note = journal.note
        journal.note = self.note  # type: ignore[method-assign]  # the one ear through which every entry goes

    def note(self, entry: Entry) -> None:
        if isinstance(entry, BytesEntry) and entry.direction is Direction.TO_BOARD:
            stop = self._stop_of[entry.device]
            if stop and stop in entry.data:
                self.stops_ns.append(entry.time_ns)
        self._note(entry)

    def first_after(self, began_ns: int) -> float | None:
        """Return how long after a moment the first stop went out [s]."""
        return min(((at - began_ns) / NS_PER_S for at in self.stops_ns if at >= began_ns), default=None)


@dataclass(slots=True)
class Bench:
    """The daemon, the robot under it, the cables between them, and who looks on."""

    robot: SimulatedRobot
    daemon: Daemon
    cables: dict[str, Cable]
    events: Subscription[Event]
    parts: list[asyncio.Task[None]]
    stops: StopWatch
    moved_ns: int = 0
    """When it was last seen to move."""
    _others: list[asyncio.Task[None]] = field(default_factory=list)

    @property
    def mode(self) -> Mode:
        """What it is allowed to do."""
        return self.daemon.supervisor.mode

    @property
    def is_moving(self) -> bool:
        """Whether the base or the head moves, or is asked to."""
        return not self.robot.at_rest or self.robot._head.arrives_us is not None

    @property
    def is_alive(self) -> bool:
        """Whether every part of the daemon still runs."""
        return not any(part.done() for part in self.parts)

    def start(self, mission: Mission) -> None:
        """Start a mission as a client does that renews its lease for as long as it lasts."""
        mission_id = self.daemon.control.start(mission, LEASE_S)
        self._others.append(asyncio.create_task(self._hold_on(mission_id)))

    async def until(self, happens: Callable[[Event], bool]) -> None:
        """Wait for something to be said."""
        async with asyncio.timeout(120.0):
            async for event in self.events:
                if happens(event):
                    return

    async def _hold_on(self, mission_id: int) -> None:
        with contextlib.suppress(RobotdError):
            while True:
                await asyncio.sleep(_RENEW_S)
                self.daemon.control.renew(mission_id)

    async def look_on(self) -> None:
        """Note when it moves."""
        while True:
            if self.is_moving:
                self.moved_ns = now_ns()
            await asyncio.sleep(_LOOK_S)

    async def end(self) -> None:
        """Let everything end."""
        for task in (*self.parts, *self._others):
            task.cancel()
        await asyncio.gather(*self.parts, *self._others, return_exceptions=True)


@contextlib.asynccontextmanager
async def bench(
    directory: Path,
    dialects: Dialects,
    readings: int = 60,
    silence_s: float = 1.0,
    worker: Compute | None = None,
    reports: dict[str, int] | None = None,
) -> AsyncIterator[Bench]:
    """Bring a daemon to life that records from its first moment; ``reports`` sets how often devices do."""
    said = dialects.settings()
    sections = {device: {**said.get(device, {}), "silence_s": silence_s, **(reports or {})} for device in DEVICES}
    text = config_text({device: f"/dev/emulated/{device}" for device in DEVICES}, sections)
    config = in_directory(replace(loads(text), sweep=SweepSettings(readings=readings)), directory)
    config = replace(config, recording=replace(config.recording, preroll_bytes=_PREROLL_BYTES))
    robot = SimulatedRobot(load_world("laboratory"), seed=4, dialects=dialects)
    journal = new_journal(config)
    compute = worker or unpaced(AtOnce())
    async with cables(robot) as laid:
        connects = {device: cable.connect for device, cable in laid.items()}
        daemon = compose(config, connects, head_on(compute, config), compute, journal)
        await daemon.control.perform(RecordStart())
        with daemon.control.events.subscribe(depth=100_000) as events:
            parts = [asyncio.create_task(part, name=name) for name, part in daemon.parts().items()]
            one = Bench(robot, daemon, laid, events, parts, StopWatch(journal, daemon))
            one._others.append(asyncio.create_task(one.look_on()))
            one._others.append(asyncio.create_task(keep_going(daemon, config.driving.silence_s)))
            try:
                await until_ready(daemon)
                yield one
            finally:
                await daemon.control.perform(Stop("the test is over"))
                await one.end()
                await daemon.control.perform(RecordStop())
