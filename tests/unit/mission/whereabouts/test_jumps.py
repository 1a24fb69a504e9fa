"""A fix where the robot cannot be is told as ambiguous, and sure only when a second look agrees."""

import math

import pytest

from robotd.contract.estimate import Circle, Cover, Extent, PoseEstimate, PoseState, Region
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2
from robotd.mission.whereabouts.tie import Tie
from robotd.mission.whereabouts.whereabouts import Whereabouts
from tests.support.places import place

NEAR_M = 0.3
ROW = (0.0, 0.0, 0.0)


def found(x_m: float, y_m: float = 0.0, heading_rad: float = 0.0, *, final: bool = True) -> PoseEstimate:
    pose = Pose2(x_m, y_m, heading_rad)
    extent = Extent(x_m - 0.05, x_m + 0.05, y_m - 0.05, y_m + 0.05, heading_rad - 0.05, heading_rad + 0.05)
    region = Region(1.0, pose, (ROW, ROW, ROW), 0.0, pose, extent, Circle(x_m, y_m, 0.1), Cover(1, ()), 1, 1, 1, ())
    return PoseEstimate(1, PoseState.LOCALIZED, pose, (region,), 9, 10, final, "m")


@pytest.fixture
def whereabouts() -> Whereabouts:
    """At the origin, by a tie that is believed."""
    at_home = Whereabouts()
    at_home.adopt(place("m"), Tie.between(IDENTITY, IDENTITY))
    return at_home


def look(whereabouts: Whereabouts, estimate: PoseEstimate, in_odom: Pose2 = IDENTITY) -> PoseEstimate:
    """Be a look round: it is weighed, told, and learned from."""
    told = whereabouts.weighed(estimate, in_odom, near_m=NEAR_M)
    whereabouts.looked(told, in_odom, near_m=NEAR_M, near_rad=0.2)
    return told


def walk(whereabouts: Whereabouts, *xs_m: float) -> None:
    for x_m in xs_m:
        whereabouts.moved(Odometry(5, Pose2(x_m, 0.0, 0.0), STANDSTILL))


def test_a_fix_where_the_robot_should_be_is_taken(whereabouts: Whereabouts) -> None:
    estimate = found(0.25)
    assert look(whereabouts, estimate) is estimate
    assert whereabouts.believed is not None
    assert whereabouts.believed.in_map(IDENTITY) == Pose2(0.25, 0.0, 0.0)


def test_a_fix_far_away_is_ambiguous_and_moves_nothing(whereabouts: Whereabouts) -> None:
    told = look(whereabouts, found(8.0))
    assert (told.state, told.best, told.jumped_m) == (PoseState.AMBIGUOUS, None, 8.0)
    assert len(told.regions) == 1
    assert whereabouts.believed is None


def test_a_second_look_that_agrees_is_sure(whereabouts: Whereabouts) -> None:
    look(whereabouts, found(8.0))
    told = look(whereabouts, found(9.05, 0.1), Pose2(1.0, 0.0, 0.0))
    assert (told.state, told.jumped_m) == (PoseState.LOCALIZED, None)
    assert whereabouts.believed is not None
    assert whereabouts.believed.in_map(Pose2(1.0, 0.0, 0.0)).x_m == pytest.approx(9.05)


def test_a_second_look_elsewhere_again_is_not(whereabouts: Whereabouts) -> None:
    look(whereabouts, found(8.0))
    told = look(whereabouts, found(-3.0), Pose2(1.0, 0.0, 0.0))
    assert (told.state, told.jumped_m) == (PoseState.AMBIGUOUS, 12.0)
    assert look(whereabouts, found(-3.0), Pose2(1.0, 0.0, 0.0)).state is PoseState.LOCALIZED


def test_odometry_may_err_by_a_share_of_the_way(whereabouts: Whereabouts) -> None:
    walk(whereabouts, 0.0, 5.0, 10.0, 5.0, 0.0)
    assert look(whereabouts, found(2.2)).state is PoseState.LOCALIZED
    assert look(whereabouts, found(3.0)).state is PoseState.AMBIGUOUS  # nothing was driven since


def test_a_heading_that_cannot_be_is_a_jump(whereabouts: Whereabouts) -> None:
    told = look(whereabouts, found(0.0, 0.0, math.pi))
    assert (told.state, told.jumped_m) == (PoseState.AMBIGUOUS, 0.0)


def test_who_knows_nothing_takes_the_first_fix(whereabouts: Whereabouts) -> None:
    assert whereabouts.doubt()
    assert look(whereabouts, found(8.0)).state is PoseState.LOCALIZED


def test_another_map_has_its_own_history(whereabouts: Whereabouts) -> None:
    look(whereabouts, found(8.0))
    whereabouts.adopt(place("n"))
    assert look(whereabouts, found(-3.0)).state is PoseState.LOCALIZED


def test_only_final_words_are_weighed(whereabouts: Whereabouts) -> None:
    estimate = found(8.0, final=False)
    assert look(whereabouts, estimate) is estimate
