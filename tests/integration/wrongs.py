"""What the robot is doing when something goes wrong, and all that can: each a word of the matrix of safety."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from firmware_proto.common import BoardState, Fault, Kill
from firmware_proto.framing import RawFrame, encode_frame
from robotd.app.compose import Daemon, compose
from robotd.app.daemon import new_journal
from robotd.config import Config
from robotd.contract.events import Event, MissionPhase, MissionProgress, RangeMeasured, SweepProgress
from robotd.contract.missions import (
    DriveStraight,
    DriveTo,
    Legs,
    Localize,
    Look,
    MapStart,
    Measure,
    Mission,
    Scan,
    Turn,
)
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, Stop
from robotd.core.broadcast import Subscription
from robotd.core.errors import RobotdError
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.transport import Connect, Transport
from robotd.hardware.wire.board import STOP_BYTES
from robotd.mission.whereabouts.tie import Tie
from robotd.recording.entries import BytesEntry
from robotd.recording.preroll import PrerollJournal
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects, Firmware
from robotd.sim.physics.body import Body
from robotd.sim.physics.steppers import StepperHead
from robotd.sim.robot import DEVICES, SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.living import in_directory, until_ready
from tests.support.own_boards import board_of, own_board
from tests.support.places import head_of, head_on, place_of, unpaced

LEASE_S = 0.5
REST_WITHIN_S = 1.5
"""The lease, or the deadman of a set-point, and the ramp from cruising speed."""
NOTICED_WITHIN_S = 1.1
"""A board that restarts falls silent for a second."""
SOON_S = 0.1
"""For bytes to travel, and the board's next word."""


class Plug:
    """An end of a line that can be pulled, and that can garble a stop."""

    def __init__(self, line: Transport) -> None:
        self.name = line.name
        self.garbles = 0
        self._line = line

    async def read(self) -> bytes:
        return await self._line.read()

    def write(self, data: bytes) -> None:
        self._line.write(data)

    def write_urgent(self, data: bytes) -> None:
        self._line.write_urgent(data[:-3] if self.garbles else data)
        self.garbles = max(0, self.garbles - 1)

    def write_past_loop(self, data: bytes) -> None:
        self._line.write_past_loop(data)

    def close(self) -> None:
        self._line.close()


class Holding:
    """Computes at once, but keeps the result of laying a sweep in or of preparing to localize until it is let go."""

    def __init__(self) -> None:
        self.go = asyncio.Event()

    async def run(self, name: str, function: Callable[..., object], *args: object) -> object:
        result = function(*args)
        if name in {"insert", "place stop", "prepare"}:
            await self.go.wait()
        return result


@dataclass(slots=True)
class Rig:
    """A daemon on an emulated robot, and everything that can go wrong with it."""

    robot: SimulatedRobot
    daemon: Daemon
    journal: PrerollJournal
    compute: Holding
    plugs: dict[str, Plug]
    events: Subscription[Event]
    parts: list[asyncio.Task[None]]
    began_ns: int = 0
    asked: list[asyncio.Task[Any]] = field(default_factory=list)

    @property
    def mode(self) -> Mode:
        return self.daemon.supervisor.mode

    @property
    def states(self) -> dict[str, BoardState]:
        return {name: board_of(self.robot, name).state for name in self.robot.boards}

    @property
    def is_quiet(self) -> bool:
        """Base at rest, head still, laser dark."""
        return self.robot.at_rest and self.robot._head.arrives_us is None and not self.robot._laser._on

    def start(self, mission: Mission) -> int:
        return self.daemon.control.start(mission, LEASE_S)

    async def keep_alive(self, mission_id: int, until: Callable[[Event], bool]) -> None:
        """Renew the lease until something happens."""
        async with asyncio.timeout(60.0):
            async for event in self.events:
                if until(event):
                    return
                with contextlib.suppress(RobotdError):
                    self.daemon.control.renew(mission_id)

    def stopped(self, device: str) -> bool:
        """Whether a stop was put on the wire of a device since things began to go wrong."""
        return any(
            isinstance(entry, BytesEntry)
            and entry.device == device
            and entry.direction is Direction.TO_BOARD
            and STOP_BYTES in entry.data
            and entry.time_ns >= self.began_ns
            for entry in self.journal.remembered
        )

    async def end(self) -> None:
        for part in self.parts:
            part.cancel()
        await asyncio.gather(*self.parts, return_exceptions=True)


def daemon_on(
    plugs: dict[str, Plug], connects: dict[str, Connect], compute: Holding, journal: PrerollJournal
) -> Daemon:
    def plugged(name: str, connect: Connect) -> Connect:
        async def connect_plugged() -> Transport:
            plugs[name] = Plug(await connect())
            return plugs[name]

        return connect_plugged

    wrapped = {name: plugged(name, connect) for name, connect in connects.items()}
    return compose(Config(), wrapped, head_on(compute), unpaced(compute), journal)


@contextlib.asynccontextmanager
async def rig(directory: Path, boards: Firmware = Firmware.PYTHON) -> AsyncIterator[Rig]:
    robot = SimulatedRobot(load_world("laboratory"), seed=4, dialects=Dialects(boards=boards))
    journal = new_journal(in_directory(Config(), directory))
    compute, plugs = Holding(), dict[str, Plug]()
    async with connectors(robot) as connects:
        daemon = daemon_on(plugs, connects, compute, journal)
        with daemon.control.events.subscribe(depth=100_000) as events:
            parts = [asyncio.create_task(part, name=name) for name, part in daemon.parts().items()]
            one = Rig(robot, daemon, journal, compute, plugs, events, parts)
            try:
                await until_ready(daemon)
                await asyncio.sleep(SOON_S)
                yield one
            finally:
                compute.go.set()
                await daemon.control.perform(Stop("the test is over"))
                await one.end()
                await asyncio.gather(*one.asked, return_exceptions=True)


# What the robot is at


async def idle(rig: Rig) -> None:
    await rig.daemon.control.perform(Arm())


async def use_blank_map(rig: Rig) -> None:
    start, here = rig.robot.start, rig.daemon.robot.drive.odometry.latest
    grid = OccupancyGrid(GridSettings().spec_covering(((start.x_m, start.y_m),), 3.0))
    assert here is not None
    blank = await place_of(head_of(rig.daemon), grid, "blank")
    rig.daemon.supervisor.use(blank, Tie.between(start, here.in_odom))


async def driving(rig: Rig) -> None:
    await rig.daemon.control.perform(Arm())
    await use_blank_map(rig)
    mission_id = rig.start(DriveTo(*rig.robot.stops_m[0], Legs.STRAIGHT))
    await rig.keep_alive(mission_id, lambda _: rig.robot._body.velocity[0] > 0.2)


async def going_back(rig: Rig) -> None:
    """Without a map."""
    await rig.daemon.control.perform(Arm())
    await rig.keep_alive(rig.start(DriveStraight(-2.0)), lambda _: rig.robot._body.velocity[0] < -0.2)


async def turning(rig: Rig) -> None:
    """Without a map."""
    await rig.daemon.control.perform(Arm())
    await rig.keep_alive(rig.start(Turn(6.0)), lambda _: rig.robot._body.velocity[1] > 0.3)


async def looking(rig: Rig) -> None:
    """The head is on its way."""
    await rig.daemon.control.perform(Arm())
    rig.start(Look(2.5, 0.0))
    await asyncio.sleep(SOON_S)
    assert rig.robot._head.arrives_us is not None


async def scanning(rig: Rig) -> None:
    """Without a map."""
    await rig.daemon.control.perform(Arm())
    mission_id = rig.start(Scan())
    await rig.keep_alive(mission_id, lambda event: isinstance(event, SweepProgress) and event.taken >= 20)


async def measuring(rig: Rig) -> None:
    """The laser is on, and nothing moves."""
    await rig.daemon.control.perform(Arm())
    mission_id = rig.start(Measure(1000))
    await rig.keep_alive(mission_id, lambda event: isinstance(event, RangeMeasured) and event.number >= 5)
    assert rig.robot._laser._on


async def sweeping(rig: Rig) -> None:
    await rig.daemon.control.perform(Arm())
    mission_id = rig.start(MapStart.of("new", (), rig.robot.start))
    await rig.keep_alive(mission_id, lambda event: isinstance(event, SweepProgress) and event.taken >= 20)


async def computing(rig: Rig) -> None:
    """The sweep is taken, and the robot waits for the map."""
    await rig.daemon.control.perform(Arm())
    mission_id = rig.start(MapStart.of("new", (), rig.robot.start))

    def is_computing(event: Event) -> bool:
        return isinstance(event, MissionProgress) and event.phase is MissionPhase.COMPUTING

    await rig.keep_alive(mission_id, is_computing)


async def preparing(rig: Rig) -> None:
    """The map is made ready to localize on, before the sweep."""
    await rig.daemon.control.perform(Arm())
    await use_blank_map(rig)
    rig.start(Localize())
    await asyncio.sleep(0.4)


async def arming(rig: Rig) -> None:
    """The base is armed already, the others are not."""
    rig.asked.append(asyncio.create_task(rig.daemon.control.perform(Arm())))
    with rig.daemon.robot.drive.status_changes.subscribe() as changes:
        assert (await changes.get()).armed
    assert not rig.daemon.robot.rangefinder.status.armed


async def starting(rig: Rig) -> None:
    """A mission was asked for in this very moment."""
    await rig.daemon.control.perform(Arm())
    rig.start(MapStart.of("new", (), rig.robot.start))


# What goes wrong


async def stop(rig: Rig) -> None:
    await rig.daemon.control.perform(Stop("enough"))


async def stop_is_garbled(rig: Rig) -> None:
    for plug in rig.plugs.values():
        plug.garbles = 3
    await rig.daemon.control.perform(Stop("enough"))


def unplug(device: str) -> Callable[[Rig], Awaitable[None]]:
    async def pull(rig: Rig) -> None:
        rig.plugs[device]._line.cut()  # type: ignore[attr-defined]  # a memory line can be cut

    return pull


def reboot(device: str) -> Callable[[Rig], Awaitable[None]]:
    async def lose_power(rig: Rig) -> None:
        board_of(rig.robot, device).reboot(4711)

    return lose_power


async def bumped(rig: Rig) -> None:
    own_board(rig.robot, "drive")._latch(Fault.BUMPER, cut=True)


def breaks(plant_of: Callable[[Rig], Body | StepperHead], fault: Fault) -> Callable[[Rig], Awaitable[None]]:
    """For a moment, which is enough to latch it."""

    async def break_it(rig: Rig) -> None:
        plant_of(rig).broken = fault
        await asyncio.sleep(SOON_S)
        plant_of(rig).broken = Fault.NONE

    return break_it


async def killed(rig: Rig) -> None:
    """Somebody else's hand on the wire of the laser."""
    rig.plugs["rangefinder"].write(encode_frame(RawFrame(Kill.TYPE, 0xABCD, b"")))


async def silent_client(rig: Rig) -> None:
    """Nobody renews the lease from here on."""


async def daemon_ends(rig: Rig) -> None:
    """What SIGTERM does: stop on every wire first."""
    rig.daemon.robot.stop_now()
    await rig.daemon.control.perform(Stop("the daemon is ending"))
    await rig.end()


async def daemon_is_killed(rig: Rig) -> None:
    for plug in rig.plugs.values():
        plug._line.cut()  # type: ignore[attr-defined]  # as above
    await rig.end()


MOVING = (driving, going_back, turning)
BY_HEAD = (looking, scanning, measuring)
ACTIVITIES = (idle, *MOVING, sweeping, computing, preparing, arming, starting)
WRONGS: dict[str, tuple[Callable[[Rig], Awaitable[None]], Mode]] = {
    "stop": (stop, Mode.DISARMED),
    "garbled stop": (stop_is_garbled, Mode.DISARMED),
    **{f"{device} unplugged": (unplug(device), Mode.DISARMED) for device in DEVICES},
    **{f"{device} rebooted": (reboot(device), Mode.DISARMED) for device in DEVICES},
    "bumper": (bumped, Mode.FAULT),
    "battery": (breaks(lambda rig: rig.robot._body, Fault.BATTERY), Mode.FAULT),
    "head motor": (breaks(lambda rig: rig.robot._head, Fault.MOTOR), Mode.FAULT),
    "laser killed": (killed, Mode.FAULT),
    "daemon ends": (daemon_ends, Mode.DISARMED),
}
