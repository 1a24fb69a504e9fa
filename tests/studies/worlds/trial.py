"""A whole daemon on a simulated robot maps a world, drives to places in it, and says where it is; in virtual time."""

import enum
import math
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.missions import DriveTo, Localize, MapStart, PriorHeading
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm
from robotd.core.clock import VirtualClockLoop
from robotd.core.pose import Pose2
from robotd.sim.buildings.world import World
from robotd.sim.physics.walls import Point
from robotd.sim.robot import SimulatedRobot
from tests.support.living import Living, living

_RIGHT_M = 0.3


class Found(enum.StrEnum):
    """What became of a place at which the robot was to say where it is."""

    RIGHT = "right"
    WRONG_AND_SURE = "wrong and sure"
    WITH_TRUTH = "ambiguous, truth named"
    WITHOUT_TRUTH = "ambiguous, truth not named"
    LOST = "lost"
    NOT_REACHED = "not reached"


@dataclass(frozen=True, slots=True)
class Trial:
    """One robot in one world."""

    seed: int
    stops: int
    swept: int
    """Stops that are on the map."""
    probes: tuple[tuple[Found, str], ...]
    """What became of each, and what was said."""

    @property
    def found(self) -> Counter[Found]:
        """How often what became of a probe."""
        return Counter(found for found, _ in self.probes)


def tried(world: World, seed: int) -> Trial:
    """Return what became of a robot with this seed."""
    loop = VirtualClockLoop()
    try:
        return loop.run_until_complete(_tried(world, seed))
    finally:
        loop.close()


async def _tried(world: World, seed: int) -> Trial:
    robot = SimulatedRobot(world, seed=seed)
    with tempfile.TemporaryDirectory(prefix="robotd-worlds-") as directory:
        async with living(Path(directory), robot) as it:
            _, mapped = await it.do(MapStart.of(world.name, robot.stops_m, robot.start))
            probes = [await _probed(it, probe) for probe in robot.probes_m]
            swept = mapped.stops if mapped.phase is MissionPhase.DONE else mapped.stop
            return Trial(seed, mapped.stops, swept, tuple(probes))


async def _probed(it: Living, place_m: Point) -> tuple[Found, str]:
    """Drive to a place, and ask there, nothing known."""
    if it.daemon.control.status.mode is not Mode.IDLE:
        await it.daemon.control.perform(Arm())
    _, driven = await it.do(DriveTo(x_m=place_m[0], y_m=place_m[1]))
    if driven.phase is not MissionPhase.DONE:
        return Found.NOT_REACHED, driven.message
    said, end = await it.do(Localize(heading=PriorHeading.UNKNOWN))
    finals = [event for event in said if isinstance(event, PoseEstimate) and event.final]
    return (_verdict(finals[-1], it.robot.truth), _words(end)) if finals else (Found.LOST, _words(end))


def _verdict(estimate: PoseEstimate, truth: Pose2) -> Found:
    if estimate.best is not None:
        return Found.RIGHT if estimate.best.distance_m(truth) <= _RIGHT_M else Found.WRONG_AND_SURE
    if estimate.state is not PoseState.AMBIGUOUS:
        return Found.LOST
    # The base turns within a sweep, after the heading that the estimate speaks of: places are compared.
    is_named = any(region.extent.holds(truth, near_m=_RIGHT_M, near_rad=math.pi) for region in estimate.regions)
    return Found.WITH_TRUTH if is_named else Found.WITHOUT_TRUTH


def _words(end: MissionProgress) -> str:
    return end.message
