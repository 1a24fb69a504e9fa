"""What the daemon is at when something goes wrong."""

from collections.abc import Awaitable, Callable

import msgspec

from firmware_proto.common import Fault
from robotd.contract.events import Event, MissionPhase, MissionProgress, RangeMeasured, Status, SweepProgress
from robotd.contract.missions import DriveStraight, DriveTo, Legs, Localize, MapStart, Measure, Scan, Turn
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm
from robotd.core.pose import Odometry
from robotd.grid.settings import GridSettings
from robotd.mission.map_requests import use_map
from robotd.mission.motion.legs import next_odometry
from tests.support.bench import Bench
from tests.support.own_boards import own_board
from tests.support.places import held

_FAST_MPS = 0.2
_FAST_RADPS = 0.3


async def disarmed(bench: Bench) -> None:
    """Nothing is allowed."""


async def idle(bench: Bench) -> None:
    """Armed, and nothing to do."""
    await bench.daemon.control.perform(Arm())


async def sweeping_for_a_map(bench: Bench) -> None:
    """In the middle of a sweep, one sweep already on the map."""
    robot = bench.robot
    await bench.daemon.control.perform(Arm())
    bench.start(MapStart.of("new", (_near(bench), *robot.stops_m), robot.start, Legs.STRAIGHT))
    await bench.until(lambda event: _is_at(event, MissionPhase.SWEEPING, 1))
    await bench.until(lambda event: isinstance(event, SweepProgress) and event.taken >= 10)


async def driving_for_a_map(bench: Bench) -> None:
    """At speed on the way to the second stop, one sweep already on the map."""
    await bench.daemon.control.perform(Arm())
    bench.start(MapStart.of("new", bench.robot.stops_m, bench.robot.start, Legs.STRAIGHT))
    await bench.until(lambda event: _is_at(event, MissionPhase.DRIVING, 1))
    await bench.until(_is_fast)


async def localizing(bench: Bench) -> None:
    """In the middle of a sweep, on a map."""
    await bench.daemon.control.perform(Arm())
    await _use_blank_map(bench)
    bench.start(Localize())
    await bench.until(lambda event: isinstance(event, SweepProgress) and event.taken >= 10)


async def driving(bench: Bench) -> None:
    """At speed on the way to a place."""
    await bench.daemon.control.perform(Arm())
    await _use_blank_map(bench)
    bench.start(DriveTo(*bench.robot.stops_m[0], Legs.STRAIGHT))
    await bench.until(_is_fast)


async def going_back_by_hand(bench: Bench) -> None:
    """At speed, backwards, without a map."""
    await bench.daemon.control.perform(Arm())
    bench.start(DriveStraight(-2.0))
    await bench.until(lambda event: isinstance(event, Odometry) and event.twist.speed_mps < -_FAST_MPS)


async def turning_by_hand(bench: Bench) -> None:
    """In the middle of a turn, without a map."""
    await bench.daemon.control.perform(Arm())
    bench.start(Turn(12.0))
    await bench.until(lambda event: isinstance(event, Odometry) and event.twist.turn_radps > _FAST_RADPS)


async def scanning(bench: Bench) -> None:
    """In the middle of a sweep, without a map."""
    await bench.daemon.control.perform(Arm())
    bench.start(Scan())
    await bench.until(lambda event: isinstance(event, SweepProgress) and event.taken >= 10)


async def measuring(bench: Bench) -> None:
    """The laser is on, the head at rest."""
    await bench.daemon.control.perform(Arm())
    bench.start(Measure(1000))
    await bench.until(lambda event: isinstance(event, RangeMeasured) and event.number >= 5)


async def faulted(bench: Bench) -> None:
    """A fault is latched, and nobody has cleared it."""
    await bench.daemon.control.perform(Arm())
    own_board(bench.robot, "drive")._latch(Fault.BUMPER, cut=True)
    await bench.until(lambda event: isinstance(event, Status) and event.mode is Mode.FAULT)


STATES: dict[str, Callable[[Bench], Awaitable[None]]] = {
    "disarmed": disarmed,
    "idle": idle,
    "map: sweep": sweeping_for_a_map,
    "map: drive": driving_for_a_map,
    "localize": localizing,
    "drive": driving,
    "move": going_back_by_hand,
    "turn": turning_by_hand,
    "scan": scanning,
    "measure": measuring,
    "fault": faulted,
}


def _near(bench: Bench) -> tuple[float, float]:
    """Return a stop so near that no time is lost on the way."""
    (x_m, y_m), start = bench.robot.stops_m[0], bench.robot.start
    return start.x_m + 0.1 * (x_m - start.x_m), start.y_m + 0.1 * (y_m - start.y_m)


def _is_at(event: Event, phase: MissionPhase, stop: int) -> bool:
    return isinstance(event, MissionProgress) and event.phase is phase and event.stop == stop


def _is_fast(event: Event) -> bool:
    return isinstance(event, Odometry) and event.twist.speed_mps > _FAST_MPS


async def _use_blank_map(bench: Bench) -> None:
    start = bench.robot.start
    await next_odometry(bench.daemon.robot.drive, 1.0)
    blank = held(GridSettings().spec_covering(((start.x_m, start.y_m),), 3.0))
    command = use_map({"map_id": "blank", "name": "blank", "robot_in_map": msgspec.to_builtins(start)}, blank, None)
    await bench.daemon.control.repeat("use_map", command.arguments)  # through the journal, so that a replay has it, too
