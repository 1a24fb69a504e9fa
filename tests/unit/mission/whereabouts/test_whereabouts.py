"""Where the robot believes it is, against a model that keeps all that ever happened and looks it up each time."""

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.contract.estimate import Circle, Cover, Extent, PoseEstimate, PoseState, Region
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.mission.whereabouts.tie import Tie
from robotd.mission.whereabouts.whereabouts import Whereabouts, unlocalized
from tests.support import places

NEAR_M, NEAR_RAD = 0.3, 0.2
ROW = (0.0, 0.0, 0.0)


def a_map(name: str = "m") -> MapInUse:
    return places.place(name)


def at(x_m: float, y_m: float = 0.0, heading_rad: float = 0.0) -> Odometry:
    return Odometry(5, Pose2(x_m, y_m, heading_rad), STANDSTILL)


def region_at(pose: Pose2) -> Region:
    """Return a region that reaches 5 cm and 0.05 rad from a pose."""
    x_m, y_m, turn_rad = pose.x_m, pose.y_m, pose.heading_rad
    extent = Extent(x_m - 0.05, x_m + 0.05, y_m - 0.05, y_m + 0.05, turn_rad - 0.05, turn_rad + 0.05)
    circle = Circle(x_m, y_m, 0.1)
    return Region(1.0, pose, (ROW, ROW, ROW), 0.0, pose, extent, circle, Cover(1, ()), 1, 1, 1, ())


def found(pose: Pose2, *, final: bool = True) -> PoseEstimate:
    return PoseEstimate(1, PoseState.LOCALIZED, pose, (region_at(pose),), 9, 10, final, "m")


def unsure(state: PoseState, *where: Pose2) -> PoseEstimate:
    return PoseEstimate(1, state, None, tuple(region_at(pose) for pose in where), 9, 10, True, "m")


# The model


def matrix(pose: Pose2) -> NDArray[np.float64]:
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return np.array([[cos, -sin, pose.x_m], [sin, cos, pose.y_m], [0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class Adopted:
    """A map came into use; ``tie`` is (map from robot, odom from robot) or None."""

    tie: tuple[Pose2, Pose2] | None


@dataclass(frozen=True)
class Found:
    """A look round at ``in_odom`` found the robot at ``pose``."""

    pose: Pose2
    in_odom: Pose2


@dataclass(frozen=True)
class Looked:
    """A look round at ``in_odom`` had regions so far from where the tie puts it; no offsets, no regions."""

    offsets_m: tuple[float, ...]
    in_odom: Pose2
    state: PoseState


@dataclass(frozen=True)
class Doubted:
    """Nobody saw what the wheels did."""


@dataclass(frozen=True)
class Said:
    """An estimate was told."""

    pose: Pose2
    final: bool


@dataclass(frozen=True)
class Moved:
    """Odometry came."""

    in_odom: Pose2


Step = Adopted | Found | Looked | Doubted | Said | Moved


@dataclass
class History:
    """Everything that ever happened; each question is answered by going through all of it."""

    steps: list[Step] = field(default_factory=list)
    predicted: dict[int, NDArray[np.float64]] = field(default_factory=dict)

    def since_map(self) -> list[tuple[int, Step]]:
        last = max((number for number, step in enumerate(self.steps) if isinstance(step, Adopted)), default=None)
        return [] if last is None else list(enumerate(self.steps))[last:]

    def tied_at(self) -> tuple[int, Pose2, Pose2] | None:
        for number, step in reversed(self.since_map()):
            if isinstance(step, Found):
                return number, step.pose, step.in_odom
            if isinstance(step, Adopted) and step.tie is not None:
                return number, *step.tie
        return None

    def is_doubted(self) -> bool:
        tied = self.tied_at()
        after = [] if tied is None else self.steps[tied[0] + 1 :]
        return any(isinstance(step, Doubted) or (isinstance(step, Looked) and self.denies(step)) for step in after)

    @staticmethod
    def denies(step: Looked) -> bool:
        if not step.offsets_m:
            return step.state is PoseState.LOST
        return min(step.offsets_m) > NEAR_M + 0.05

    def map_from_odom(self) -> NDArray[np.float64] | None:
        tied = self.tied_at()
        return None if tied is None else matrix(tied[1]) @ np.linalg.inv(matrix(tied[2]))

    def last_said(self) -> NDArray[np.float64] | None:
        """Return what was said last on this map since odometry was last believed no longer."""
        steps = self.since_map()
        for place in range(len(steps) - 1, -1, -1):
            number, step = steps[place]
            if isinstance(step, Said) and step.final:
                return matrix(step.pose)
            if number in self.predicted:
                return self.predicted[number]
            if isinstance(step, Doubted) and History(self.steps[:number]).is_believed():
                return None
        return None

    def is_believed(self) -> bool:
        return self.tied_at() is not None and not self.is_doubted()

    def predict(self, in_odom: Pose2) -> NDArray[np.float64] | None:
        """Return what odometry makes of it, if that is news; to be asked before the step is written down."""
        tie, said = self.map_from_odom(), self.last_said()
        if tie is None or self.is_doubted():
            return None
        pose = tie @ matrix(in_odom)
        if said is not None:
            moved = np.linalg.inv(said) @ pose
            turned_rad = abs(math.atan2(moved[1, 0], moved[0, 0]))
            if math.hypot(moved[0, 2], moved[1, 2]) <= 0.02 and turned_rad <= 0.02:
                return None
        self.predicted[len(self.steps)] = pose
        return pose


HERE = Pose2(1.0, -2.0, math.pi - 0.004)
BESIDE = (
    HERE,
    Pose2(1.013, -2.0, math.pi - 0.004),
    Pose2(1.03, -2.0, math.pi - 0.004),
    Pose2(1.0, -2.0, 0.005 - math.pi),
    Pose2(1.0, -2.0, 0.05 - math.pi),
)
"""Poses that are nearly one, nearer or farther than what is worth saying, and on both sides of the half turn."""


def some_pose(draw: random.Random) -> Pose2:
    if draw.random() < 0.8:
        return draw.choice(BESIDE)
    return Pose2(draw.uniform(-3.0, 3.0), draw.uniform(-3.0, 3.0), draw.uniform(-math.pi, math.pi))


def some_tie(draw: random.Random) -> tuple[Pose2, Pose2]:
    return (HERE, HERE) if draw.random() < 0.7 else (some_pose(draw), some_pose(draw))


def some_adoption(draw: random.Random) -> Adopted:
    return Adopted(some_tie(draw) if draw.random() < 0.7 else None)


def some_step(draw: random.Random) -> Step:
    """Return something that may happen; mostly that odometry comes."""
    chance = draw.random()
    if chance < 0.5:
        return Moved(some_pose(draw))
    if chance < 0.6:
        return some_adoption(draw)
    if chance < 0.75:
        return Found(*some_tie(draw))
    if chance < 0.85:
        return Said(some_pose(draw), draw.random() < 0.5)
    if chance < 0.9:
        return Doubted()
    offsets_m = tuple(draw.choice((0.0, 0.2, 0.5, 3.0)) for _ in range(draw.randrange(4)))
    return Looked(offsets_m, some_pose(draw), draw.choice((PoseState.LOST, PoseState.AMBIGUOUS)))


def take(whereabouts: Whereabouts, history: History, step: Step) -> PoseEstimate | None:
    """Let both live through a step; return what is predicted."""
    within = {"near_m": NEAR_M, "near_rad": NEAR_RAD}
    match step:
        case Adopted(tie):
            whereabouts.adopt(a_map(), None if tie is None else Tie.between(*tie))
        case Found(pose, in_odom):
            whereabouts.looked(found(pose), in_odom, **within)
        case Looked(offsets_m, in_odom, state):
            map_from_odom = history.map_from_odom()
            here = np.eye(3) if map_from_odom is None else map_from_odom @ matrix(in_odom)
            turned_rad = math.atan2(here[1, 0], here[0, 0])
            where = [Pose2(here[0, 2] + offset_m, here[1, 2], turned_rad) for offset_m in offsets_m]
            whereabouts.looked(unsure(state, *where), in_odom, **within)
        case Doubted():
            assert whereabouts.doubt() is history.is_believed()
        case Said(pose, final):
            whereabouts.said(found(pose, final=final))
        case Moved(in_odom):
            expected = history.predict(in_odom)
            said = whereabouts.moved(Odometry(7, in_odom, STANDSTILL))
            assert (said is None) is (expected is None)
            return said
    return None


@pytest.mark.parametrize("seed", range(200))
def test_it_believes_what_all_that_happened_says(seed: int, record_property: Callable[[str, object], None]) -> None:
    record_property("property_cases", 1)
    draw = random.Random(seed)
    whereabouts, history = Whereabouts(), History()
    for step in (some_adoption(draw), *(some_step(draw) for _ in range(40))):
        said = take(whereabouts, history, step)
        if said is not None:
            expected = history.predicted[len(history.steps)]
            assert said.best is not None
            np.testing.assert_allclose(matrix(said.best), expected, atol=1e-9)
            assert (said.state, said.time_ns, said.map_id, said.final) == (PoseState.PREDICTED, 7, "m", True)
        history.steps.append(step)
        assert (whereabouts.believed is not None) is history.is_believed()
        assert (whereabouts.map_in_use is not None) is bool(history.since_map())
    in_odom = some_pose(draw)
    tie = history.map_from_odom()
    here, heading_rad = Odometry(9, in_odom, STANDSTILL), None
    pose = whereabouts.pose_of(here)
    assert (pose is not None) is history.is_believed()
    if tie is not None:
        expected = tie @ matrix(in_odom)
        heading_rad = whereabouts.heading_of(here)
        assert heading_rad is not None
        assert math.cos(heading_rad - math.atan2(expected[1, 0], expected[0, 0])) == pytest.approx(1.0)
        if pose is not None:
            np.testing.assert_allclose(matrix(pose), expected, atol=1e-9)
    assert (whereabouts.heading_of(here) is None) is (tie is None)


# By hand


def test_a_tie_puts_the_robot_where_it_is_said_to_be_and_carries_it_on() -> None:
    here = Whereabouts()
    here.adopt(a_map())
    assert here.pose_of(at(1.0)) is None
    here.looked(found(Pose2(2.0, 3.0, math.pi / 2)), at(1.0).in_odom, near_m=NEAR_M, near_rad=NEAR_RAD)
    assert here.pose_of(at(1.0)) == Pose2(2.0, 3.0, math.pi / 2)
    moved = here.pose_of(at(1.5))
    assert moved is not None
    assert (moved.x_m, moved.y_m) == pytest.approx((2.0, 3.5))


def test_a_pose_is_predicted_when_the_robot_has_moved_or_turned_far_enough_to_matter() -> None:
    here = Whereabouts()
    here.adopt(a_map(), Tie(IDENTITY))
    poses = (
        at(0.0),
        at(0.01),
        at(0.03),
        at(0.03, heading_rad=0.01),
        at(0.03, heading_rad=0.03),
        at(0.03, heading_rad=6.31),
    )
    said = [here.moved(odometry) for odometry in poses]
    assert [estimate is not None for estimate in said] == [True, False, True, False, True, False]
    last = said[4]
    assert last is not None
    assert (last.state, last.best, last.time_ns, last.map_id) == (PoseState.PREDICTED, Pose2(0.03, 0.0, 0.03), 5, "m")


def test_a_look_round_that_allows_no_answer_says_nothing_against_the_tie_but_one_that_is_lost_does() -> None:
    here = Whereabouts()
    here.adopt(a_map(), Tie(IDENTITY))
    here.looked(unsure(PoseState.AMBIGUOUS), IDENTITY, near_m=NEAR_M, near_rad=NEAR_RAD)
    assert here.believed is not None
    here.looked(unsure(PoseState.LOST), IDENTITY, near_m=NEAR_M, near_rad=NEAR_RAD)
    assert here.pose_of(at(0.0)) is None
    assert here.heading_of(at(0.0, heading_rad=0.4)) == pytest.approx(0.4)


def test_doubt_is_news_once_and_only_where_something_was_believed() -> None:
    here = Whereabouts()
    assert not here.doubt()
    here.adopt(a_map())
    assert not here.doubt()
    here.adopt(a_map(), Tie(IDENTITY))
    assert [here.doubt(), here.doubt()] == [True, False]
    assert here.moved(at(4.0)) is None


def test_not_to_know_is_said_and_not_left_to_silence() -> None:
    estimate = unlocalized(3, "m")
    assert (estimate.state, estimate.best, estimate.regions) == (PoseState.LOST, None, ())
