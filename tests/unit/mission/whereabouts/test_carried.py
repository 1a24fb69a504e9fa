"""What is carried from look to look: places that cannot be reached are not told, and one that is left is sure."""

import math
from dataclasses import replace

import pytest

from robotd.contract.estimate import Circle, Contradiction, Cover, Extent, PoseEstimate, PoseState, Region
from robotd.core.motion_error import MotionError
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2
from robotd.mission.whereabouts.carried import Carried, Sure
from robotd.mission.whereabouts.tie import Tie
from robotd.mission.whereabouts.whereabouts import Whereabouts
from tests.support.places import place

NEAR_M = 0.3
ROW = (0.0, 0.0, 0.0)
SURE = Sure(doubt_max=0.05, is_proof=False)


def region(x_m: float, heading_rad: float = 0.0, *, belief: float = 0.45, half_m: float = 0.05) -> Region:
    pose = Pose2(x_m, 0.0, heading_rad)
    low_rad = heading_rad - 0.05
    extent = Extent(x_m - half_m, x_m + half_m, -0.05, 0.05, low_rad, low_rad + 0.1)
    return Region(belief, pose, (ROW, ROW, ROW), 0.0, pose, extent, Circle(x_m, 0.0, 0.1), Cover(1, ()), 1, 1, 1, ())


def unsure(*regions: Region) -> PoseEstimate:
    return PoseEstimate(1, PoseState.AMBIGUOUS, None, regions, 9, 10, True, "m", belief_nowhere=0.001)


def sure(x_m: float) -> PoseEstimate:
    one = region(x_m)
    return PoseEstimate(1, PoseState.LOCALIZED, one.pose, (one,), 9, 10, True, "m")


LOST = PoseEstimate(1, PoseState.LOST, None, (), 0, 10, True, "m")


def somewhere(sure_if: Sure = SURE) -> Whereabouts:
    whereabouts = Whereabouts(Carried(MotionError(), sure_if))
    whereabouts.adopt(place("m"))
    return whereabouts


def go(whereabouts: Whereabouts, *xs_m: float) -> None:
    for x_m in xs_m:
        whereabouts.moved(Odometry(5, Pose2(x_m, 0.0, 0.0), STANDSTILL))


def look(whereabouts: Whereabouts, estimate: PoseEstimate, x_m: float = 0.0) -> PoseEstimate:
    """Be a look round: it begins, is weighed, told, and learned from."""
    here = Pose2(x_m, 0.0, 0.0)
    whereabouts.looks(here)
    told = whereabouts.weighed(estimate, here, near_m=NEAR_M)
    whereabouts.looked(told, here, near_m=NEAR_M, near_rad=0.2)
    return told


def test_a_place_that_cannot_be_reached_is_not_told_and_the_one_that_is_left_is_sure() -> None:
    whereabouts = somewhere()
    assert look(whereabouts, unsure(region(0.0), region(10.0, math.pi))).state is PoseState.AMBIGUOUS
    go(whereabouts, 0.0, 1.0, 2.0)
    told = look(whereabouts, unsure(region(12.0), region(2.0)), 2.0)
    assert (told.state, told.best, told.by_history) == (PoseState.LOCALIZED, Pose2(2.0, 0.0, 0.0), True)
    assert (len(told.regions), told.unreachable) == (1, 1)
    assert whereabouts.believed is not None
    assert whereabouts.believed.in_map(Pose2(2.0, 0.0, 0.0)) == Pose2(2.0, 0.0, 0.0)


def test_several_that_are_left_stay_and_the_rest_is_counted() -> None:
    whereabouts = somewhere()
    look(whereabouts, unsure(region(0.0), region(20.0), region(10.0, math.pi)))
    go(whereabouts, 0.0, 2.0)
    told = look(whereabouts, unsure(region(2.0), region(12.0), region(22.0)), 2.0)
    assert (told.state, told.unreachable) == (PoseState.AMBIGUOUS, 1)
    assert [one.pose.x_m for one in told.regions] == [2.0, 22.0]


@pytest.mark.parametrize(
    "left",
    [
        replace(unsure(region(2.0), region(12.0)), belief_nowhere=0.3),
        replace(unsure(region(2.0), region(12.0)), belief_aside=0.3),
        unsure(region(2.0, half_m=3.0), region(12.0)),
        unsure(replace(region(2.0), covariance=((4.0, 0.0, 0.0), ROW, ROW)), region(12.0)),
    ],
    ids=["nowhere", "aside", "no one place", "along a corridor"],
)
def test_one_that_is_left_is_not_sure_where_more_speaks_against_it(left: PoseEstimate) -> None:
    whereabouts = somewhere()
    look(whereabouts, unsure(region(0.0, half_m=2.0), region(10.0, math.pi)))
    go(whereabouts, 0.0, 2.0)
    told = look(whereabouts, left, 2.0)
    assert (told.state, told.best, told.unreachable) == (PoseState.AMBIGUOUS, None, 1)


def test_where_regions_are_proven_belief_has_no_say() -> None:
    whereabouts = somewhere(Sure(0.05, is_proof=True))
    look(whereabouts, unsure(region(0.0), region(10.0, math.pi)))
    go(whereabouts, 0.0, 2.0)
    told = look(whereabouts, replace(unsure(region(2.0), region(12.0)), belief_nowhere=0.9), 2.0)
    assert told.state is PoseState.LOCALIZED


def test_who_is_carried_off_is_noticed_at_the_next_look_and_sure_at_the_one_after() -> None:
    whereabouts = somewhere()
    assert look(whereabouts, sure(0.0)).state is PoseState.LOCALIZED
    told = look(whereabouts, sure(8.0))
    assert (told.state, told.contradiction) == (PoseState.AMBIGUOUS, Contradiction.CARRIED)
    assert told.jumped_m == pytest.approx(8.0, abs=0.01)
    assert whereabouts.believed is None
    go(whereabouts, 0.0, 1.0)
    again = look(whereabouts, sure(9.0), 1.0)
    assert (again.state, again.contradiction) == (PoseState.LOCALIZED, None)


def test_who_is_carried_to_where_rooms_are_alike_is_noticed_too() -> None:
    whereabouts = somewhere()
    look(whereabouts, sure(0.0))
    told = look(whereabouts, unsure(region(8.0), region(16.0)))
    assert (told.state, told.contradiction, len(told.regions)) == (PoseState.AMBIGUOUS, Contradiction.CARRIED, 2)


def test_a_wrong_fix_is_a_rival_of_what_was_known_and_the_next_look_says_which() -> None:
    whereabouts = somewhere()
    look(whereabouts, sure(0.0))
    look(whereabouts, sure(8.0))
    told = look(whereabouts, sure(0.0))
    assert (told.state, told.contradiction) == (PoseState.LOCALIZED, None)


def test_being_lost_for_a_look_loses_nothing_that_was_known() -> None:
    whereabouts = somewhere()
    look(whereabouts, sure(0.0))
    assert look(whereabouts, LOST) is LOST
    assert look(whereabouts, sure(8.0)).contradiction is Contradiction.CARRIED


def test_more_regions_than_can_be_told_exclude_nothing() -> None:
    whereabouts = somewhere()
    look(whereabouts, sure(0.0))
    many = replace(unsure(region(8.0), region(16.0)), regions_left_out=3)
    assert look(whereabouts, many) is many


def test_what_the_base_turns_for_a_sweep_counts_to_the_way_after_it() -> None:
    whereabouts = somewhere()
    whereabouts.looks(IDENTITY)
    for heading_rad in (0.0, 1.0, 2.0, 3.0, -3.0, -2.0, -1.0, 0.0):
        whereabouts.moved(Odometry(5, Pose2(0.0, 0.0, heading_rad), STANDSTILL))
    whereabouts.weighed(sure(0.0), IDENTITY, near_m=NEAR_M)
    # Once round on the spot: the heading may be off by a good deal, and by more than for a robot that stood.
    turned = replace(sure(0.0), regions=(region(0.0, 0.9),), best=Pose2(0.0, 0.0, 0.9))
    assert look(whereabouts, turned).state is PoseState.LOCALIZED
    assert look(whereabouts, sure(0.0)).contradiction is not None


def test_a_tie_that_somebody_made_is_where_a_history_begins() -> None:
    whereabouts = somewhere()
    whereabouts.adopt(place("n"), Tie.between(IDENTITY, IDENTITY))
    assert look(whereabouts, sure(8.0)).contradiction is Contradiction.CARRIED
    whereabouts.adopt(place("o"), Tie.between(IDENTITY, IDENTITY))
    go(whereabouts, *(float(x_m) for x_m in range(6)))
    assert look(whereabouts, sure(6.2), 5.0).state is PoseState.LOCALIZED


def test_who_saw_nothing_of_the_way_takes_the_next_fix() -> None:
    whereabouts = somewhere()
    look(whereabouts, sure(0.0))
    assert whereabouts.doubt()
    assert look(whereabouts, sure(8.0)).state is PoseState.LOCALIZED


def test_what_is_said_so_far_is_weighed_and_nothing_is_learned_of_it() -> None:
    whereabouts = somewhere()
    look(whereabouts, sure(0.0))
    so_far = whereabouts.weighed(replace(sure(8.0), final=False), IDENTITY, near_m=NEAR_M)
    assert (so_far.state, so_far.contradiction) == (PoseState.AMBIGUOUS, Contradiction.CARRIED)
    between = whereabouts.weighed(replace(unsure(region(0.0), region(8.0)), final=False), IDENTITY, near_m=NEAR_M)
    assert (between.state, between.by_history) == (PoseState.LOCALIZED, True)
    assert look(whereabouts, sure(8.0)).contradiction is Contradiction.CARRIED
