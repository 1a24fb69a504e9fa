"""One robot each: it looks until it is sure; finds out in which of two equal rooms it is; is carried off."""

import enum
import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, field

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.motion_error import MotionError
from robotd.core.pose import IDENTITY, Pose2
from robotd.head.job_table import perform
from robotd.head.jobs import ChooseSafeWay
from robotd.mission.whereabouts.carried import Carried, Sure
from robotd.sensing.rivals import Rival
from tests.studies.senses.ground import Ground
from tests.studies.senses.looks import adaptive_look

_RIGHT_M = 0.3
SAME_M = 0.3
_IN_VAIN_MAX = 6
_SPEED_MPS = 0.4
CARRIED_M = 2.0


class Came(enum.StrEnum):
    """What came of it."""

    RIGHT = "right"
    WRONG = "wrong and sure"
    UNSURE = "ambiguous"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class Look:
    """A look until it is sure."""

    came: Came
    readings: int


@dataclass(frozen=True, slots=True)
class Resolving:
    """A robot that drove until it knew."""

    came: Came
    stops: int
    way_m: float


@dataclass(frozen=True, slots=True)
class CarriedOff:
    """A robot that was carried from where it knew itself to somewhere else."""

    noticed: bool
    came: Came
    """After a second look."""


def came(estimate: PoseEstimate, truth: Pose2) -> Came:
    """Hold an estimate against the truth."""
    if estimate.best is not None:
        return Came.RIGHT if estimate.best.distance_m(truth) <= _RIGHT_M else Came.WRONG
    return Came.LOST if estimate.state is PoseState.LOST else Came.UNSURE


async def look(ground: Ground, seed: int) -> Look:
    """Look round somewhere, nothing known."""
    draw = random.Random(f"look {seed}")
    truth = ground.somewhere(draw)
    estimate, readings = await adaptive_look(ground, truth, draw)
    return Look(came(estimate, truth), readings)


@dataclass
class _Robot:
    """A robot with wheels that err, and what it carries along."""

    ground: Ground
    truth: Pose2
    draw: random.Random
    in_odom: Pose2 = IDENTITY
    carried: Carried = field(default_factory=lambda: Carried(MotionError(), Sure(0.05, is_proof=False)))

    async def look(self) -> PoseEstimate:
        self.carried.moved(self.in_odom)
        self.carried.looks(self.in_odom)
        estimate, _ = await adaptive_look(self.ground, self.truth, self.draw)
        return self.carried.weighed(estimate, None, self.in_odom, SAME_M)

    def drive(self, corners_m: Sequence[tuple[float, float]]) -> None:
        """Go to corners, as they lie to where it stands: each leg 5 % too far or not, and up to 3 degrees aside."""
        begin = self.in_odom
        for corner_m in corners_m:
            aim = self.in_odom.inverse().transform(*begin.transform(*corner_m))
            way_m, turn_rad = math.hypot(*aim), math.atan2(aim[1], aim[0])
            self.in_odom @= Pose2(aim[0], aim[1], turn_rad)
            self.carried.moved(self.in_odom)
            true_m, aside_rad = way_m * self.draw.uniform(0.95, 1.05), math.radians(self.draw.uniform(-3.0, 3.0))
            self.truth = self.truth @ Pose2(0.0, 0.0, turn_rad + aside_rad) @ Pose2(true_m, 0.0, 0.0)


async def resolve(ground: Ground, seed: int) -> Resolving:
    """Find out which of several places it is, as the mission does (`mission/missions/resolving.py`)."""
    draw = random.Random(f"resolve {seed}")
    robot = _Robot(ground, ground.somewhere(draw), draw)
    estimate, stops, way_m, in_vain = await robot.look(), 1, 0.0, 0
    fewest = len(estimate.regions)
    while estimate.state is PoseState.AMBIGUOUS and in_vain < _IN_VAIN_MAX and not estimate.regions_left_out:
        rivals = tuple(Rival.of(region, ground.grid.spec) for region in estimate.regions)
        way = perform(ground.desk, ChooseSafeWay(ground.map, rivals, ground.cutoff_m, _SPEED_MPS)).way
        if way is None:
            break
        robot.drive(way.corners_m)
        estimate, stops, way_m = await robot.look(), stops + 1, way_m + way.length_m
        in_vain = 0 if len(estimate.regions) < fewest else in_vain + 1
        fewest = min(fewest, len(estimate.regions))
    return Resolving(came(estimate, robot.truth), stops, way_m)


async def carried_off(ground: Ground, seed: int) -> CarriedOff | None:
    """Carry a robot off that knew where it was; None if it did not."""
    draw = random.Random(f"carried {seed}")
    robot = _Robot(ground, ground.somewhere(draw), draw)
    if came(await robot.look(), robot.truth) is not Came.RIGHT:
        return None
    before = robot.truth
    while robot.truth.distance_m(before) < CARRIED_M:
        robot.truth = ground.somewhere(draw)
    first = await robot.look()
    noticed = first.contradiction is not None or first.state is PoseState.LOST
    return CarriedOff(noticed, came(await robot.look(), robot.truth))
