"""One trial: a device lies while the daemon is at something; and what must be true all the same."""

import asyncio
import contextlib
import random
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from firmware_proto.common import Fault
from robotd.contract.device_status import LinkState
from robotd.contract.events import Event, MissionPhase, MissionProgress, SweepProgress
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, Clear, Stop
from robotd.contract.topics import Topic, encode_frame, to_wire
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.hardware.devices.vendor_device import VendorDevice
from robotd.mission.motion.legs import next_odometry
from robotd.mission.whereabouts.tie import Tie
from tests.studies.liars.liar import Liar
from tests.studies.liars.lies import Tongue
from tests.support.bench import Bench
from tests.support.living import until_ready
from tests.support.own_boards import own_board
from tests.support.places import head_of, place_of

LOOK_S = 0.1
REST_S = 1.6
"""From a stop to rest: the ramp, and what a base without acknowledgements needs until it has heard."""
AFTERWARDS_S = 2.0
"""How long it is looked at once it stands, or has nothing to do."""
FROZEN_S = 15.0
"""A mission under way must have advanced, or ended, within this: a sweep tells of ten readings at a time, each of which
may wait a second for its rangefinder; turning the head may take 5 s, a stalled base 3 s."""
RESETS_S = 45.0
"""The same of a head that finds its stops again, which its mission says."""
TOLD_WITHIN_S = 4.0


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a trial."""

    robot: str
    state: str
    device: str
    seed: int
    told: tuple[str, ...]
    """Empty if there was nothing to lie about."""
    end: str
    """``died``, ``internal``, ``moved``, ``froze``; or how it went: ``faulted``, ``disarmed``, ``went on``."""
    detail: str = ""

    @property
    def is_failure(self) -> bool:
        """Whether it may not be so."""
        return self.end in {"died", "internal", "moved", "froze", "lost"}


async def come_to_rest(it: Bench) -> None:
    """Bring a bench on which anything may have happened back to where nothing is wrong, disarmed."""
    for cable in it.cables.values():
        cable.mend()
    for _ in range(8):
        await it.daemon.control.perform(Stop("between two trials"))
        with contextlib.suppress(RobotdError, TimeoutError):
            await until_ready(it.daemon)
            await asyncio.sleep(0.3)
            await it.daemon.control.perform(Clear())
            await asyncio.sleep(0.3)
            if it.mode is Mode.DISARMED and not it.daemon.robot.absent and not it.daemon.robot.faults:
                return
        await asyncio.sleep(1.0)
    status = it.daemon.control.status
    raise AssertionError(f"it does not come back: {status.mode}, {status.reason}, {it.daemon.robot.faults}")


async def disarmed(it: Bench) -> None:
    """Nothing is allowed."""


async def idle(it: Bench) -> None:
    """Armed, and nothing to do."""
    await it.daemon.control.perform(Arm())


async def map_sweep(it: Bench) -> None:
    """Sweeping for a map."""
    await it.daemon.control.perform(Arm())
    it.start(MapStart.of("new", (_other_end(it),), it.robot.truth, Legs.STRAIGHT))


async def map_drive(it: Bench) -> None:
    """On the way to the second stop of a map."""
    await map_sweep(it)
    await _until(it, lambda event: isinstance(event, MissionProgress) and event.phase is MissionPhase.DRIVING)
    await asyncio.sleep(1.0)


async def localizing(it: Bench) -> None:
    """Sweeping on a map."""
    await it.daemon.control.perform(Arm())
    await _use_blank_map(it)
    it.start(Localize())


async def driving(it: Bench) -> None:
    """On the way to a place."""
    await it.daemon.control.perform(Arm())
    await _use_blank_map(it)
    it.start(DriveTo(*_other_end(it), Legs.STRAIGHT))
    await asyncio.sleep(1.0)


async def faulted(it: Bench) -> None:
    """A fault is latched."""
    await it.daemon.control.perform(Arm())
    drive = it.daemon.robot.drive
    if isinstance(drive, VendorDevice):
        drive._latch("bumper")
    else:
        own_board(it.robot, "drive")._latch(Fault.BUMPER, cut=True)
    await asyncio.sleep(0.3)


STATES: dict[str, Callable[[Bench], Awaitable[None]]] = {
    "disarmed": disarmed,
    "idle": idle,
    "map: sweep": map_sweep,
    "map: drive": map_drive,
    "localize": localizing,
    "drive": driving,
    "fault": faulted,
}


async def try_once(it: Bench, robot: str, state: str, device: str, seed: int, tongue: Tongue) -> Outcome:
    """Bring the daemon to a state, let a device lie, and look on."""
    await come_to_rest(it)
    try:
        await STATES[state](it)
    except (RobotdError, TimeoutError) as error:
        return Outcome(robot, state, device, seed, (), "not tried", str(error))
    _drain(it)
    liar = Liar(random.Random(seed), tongue)
    watch = _Watch(it, liar)
    it.cables[device].set_fault(liar)
    end, detail = await watch.outcome()
    return Outcome(robot, state, device, seed, tuple(liar.told), end, detail)


class _Watch:
    def __init__(self, it: Bench, liar: Liar) -> None:
        self._it = it
        self._liar = liar
        self._began_ns = now_ns()
        self._advanced_ns = self._began_ns
        self._stopped_ns: int | None = None
        if it.mode not in {Mode.IDLE, Mode.UNDER_WAY}:
            self._stopped_ns = it.moved_ns
        self._where = it.robot.truth
        self._patience_s = FROZEN_S

    async def outcome(self) -> tuple[str, str]:
        """Look on until all is clear; return how it went."""
        while True:
            await asyncio.sleep(LOOK_S)
            wrong = self._wrong()
            if wrong is not None:
                return wrong
            if self._is_clear():
                break
        status = self._it.daemon.control.status
        if (late := self._silently_late()) is not None:
            return "froze", late
        if self._it.mode in {Mode.FAULT, Mode.DISARMED}:
            return ("faulted" if self._it.mode is Mode.FAULT else "disarmed"), status.reason
        return "went on", ""

    def _wrong(self) -> tuple[str, str] | None:
        it = self._it
        if not it.is_alive:
            errors = [repr(part.exception()) for part in it.parts if part.done() and not part.cancelled()]
            return "died", "; ".join(errors)
        try:
            self._take_events()
        except (ArithmeticError, TypeError, ValueError) as error:
            return "died", f"what happened cannot be sent: {error!r}"
        status = it.daemon.control.status
        if "internal error" in status.reason:
            return "internal", status.reason
        if it.mode is Mode.UNDER_WAY or it.mode is Mode.IDLE:
            self._stopped_ns = None
        elif self._stopped_ns is None:
            self._stopped_ns = now_ns()
        if self._stopped_ns is not None and it.moved_ns > self._stopped_ns + REST_S * NS_PER_S:
            return "moved", f"{(it.moved_ns - self._stopped_ns) / NS_PER_S:.2f} s after the stop: {status.reason}"
        if it.mode is Mode.UNDER_WAY and now_ns() - self._advanced_ns > self._patience_s * NS_PER_S:
            return "froze", f"{it.mode}, nothing came of it for {self._patience_s:g} s"
        return None

    def _take_events(self) -> None:
        """See that each event can be sent, and whether the mission advances."""
        for event in _drain(self._it):
            encode_frame(Topic.STATUS, "liars", 0, to_wire(event)[1])
            if isinstance(event, (MissionProgress, SweepProgress)):
                self._advanced_ns = now_ns()
            if isinstance(event, MissionProgress):
                self._patience_s = RESETS_S if "it is reset" in event.message else FROZEN_S
        where = self._it.robot.truth
        turned_rad = abs(where.heading_rad - self._where.heading_rad)
        if where.distance_m(self._where) > 0.01 or turned_rad > 0.01:
            self._where, self._advanced_ns = where, now_ns()

    def _is_clear(self) -> bool:
        """Whether nothing more will come of the lie."""
        since_s = self._liar.since_s
        waited_s = (now_ns() - self._began_ns) / NS_PER_S
        if since_s is None:
            return waited_s > TOLD_WITHIN_S or (self._it.mode is not Mode.UNDER_WAY and waited_s > AFTERWARDS_S)
        if self._stopped_ns is not None:
            return (now_ns() - max(self._stopped_ns, self._began_ns)) / NS_PER_S > REST_S + 0.5
        if self._it.mode is Mode.UNDER_WAY:
            return since_s > AFTERWARDS_S and self._advanced_ns > (self._liar.told_ns or 0) + NS_PER_S
        return since_s > AFTERWARDS_S

    def _silently_late(self) -> str | None:
        """Say so if odometry's time stands still and nobody is told."""
        drive = self._it.daemon.robot.drive
        latest = drive.odometry.latest
        if drive.status.link is not LinkState.READY or drive.status.faults or latest is None:
            return None
        late_s = (now_ns() - latest.time_ns) / NS_PER_S
        return f"odometry is {late_s:.1f} s old, and nothing is said of it" if abs(late_s) > AFTERWARDS_S else None


def _drain(it: Bench) -> list[Event]:
    events = list(it.events._items)
    it.events._items.clear()
    return events


async def _until(it: Bench, happens: Callable[[Event], bool]) -> None:
    async with asyncio.timeout(30.0):
        async for event in it.events:
            if happens(event):
                return


def _other_end(it: Bench) -> tuple[float, float]:
    """Return the farther end of a way that is known to be free."""
    start, (x_m, y_m) = it.robot.start, it.robot.stops_m[0]
    ends = ((start.x_m, start.y_m), (x_m, y_m))
    here = it.robot.truth
    return max(ends, key=lambda end: (end[0] - here.x_m) ** 2 + (end[1] - here.y_m) ** 2)


async def _use_blank_map(it: Bench) -> None:
    start = it.robot.start
    here = await next_odometry(it.daemon.robot.drive, 1.0)
    grid = OccupancyGrid(GridSettings().spec_covering(((start.x_m, start.y_m),), 3.0))
    blank = await place_of(head_of(it.daemon), grid, "blank")
    it.daemon.supervisor.use(blank, Tie.between(it.robot.truth, here.in_odom))
