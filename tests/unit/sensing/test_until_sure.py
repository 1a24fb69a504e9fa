"""When a look round is over: two answers that agree, with enough that is new between them."""

import math
from collections.abc import Sequence

import pytest

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.pose import Pose2
from robotd.sensing.until_sure import UntilSure

ALL_ROUND = (0.0, 1.7, 3.2, -1.2)
HERE = Pose2(1.0, 2.0, 0.5)


def sure(pose: Pose2) -> PoseEstimate:
    return PoseEstimate(1, PoseState.LOCALIZED, pose, (), 16, 16, False, "m")


UNSURE = PoseEstimate(1, PoseState.AMBIGUOUS, None, (), 16, 16, False, "m")


def after(*told: tuple[Sequence[float], PoseEstimate]) -> UntilSure:
    """Return a look after some answers, each to more readings."""
    until = UntilSure(near_m=0.3, near_rad=0.1)
    for bearings_rad, estimate in told:
        for bearing_rad in bearings_rad:
            until.measured(bearing_rad)
        until.answered(estimate)
    return until


def test_two_answers_that_agree_are_enough() -> None:
    nearly = Pose2(1.1, 2.1, 0.45)
    assert after((ALL_ROUND, sure(HERE)), (ALL_ROUND, sure(nearly))).is_sure


def test_the_first_answer_is_not_however_many_readings_it_has() -> None:
    assert not after((ALL_ROUND * 10, sure(HERE))).is_sure


@pytest.mark.parametrize("other", [Pose2(1.5, 2.0, 0.5), Pose2(1.0, 2.0, 0.7)])
def test_answers_that_differ_are_not(other: Pose2) -> None:
    until = after((ALL_ROUND, sure(HERE)), (ALL_ROUND, sure(other)))
    assert not until.is_sure
    for bearing_rad in ALL_ROUND:
        until.measured(bearing_rad)
    until.answered(sure(other))
    assert until.is_sure


def test_an_answer_that_was_taken_back_does_not_count() -> None:
    assert not after((ALL_ROUND, sure(HERE)), (ALL_ROUND, UNSURE), (ALL_ROUND, sure(HERE))).is_sure


def test_readings_to_one_side_are_not_new_enough() -> None:
    assert not after((ALL_ROUND, sure(HERE)), ((0.1, 0.2, 0.3, 0.4), sure(HERE))).is_sure


def test_few_readings_are_not_new_enough_and_more_are() -> None:
    until = after((ALL_ROUND, sure(HERE)), ((0.0, 2.0), sure(HERE)))
    assert not until.is_sure
    until.measured(-2.0)
    until.measured(math.pi)
    until.answered(sure(HERE))
    assert until.is_sure


def test_readings_that_measure_nothing_are_asked_for_in_vain() -> None:
    assert not after((ALL_ROUND, sure(HERE)), ((), sure(HERE)), ((), sure(HERE))).is_sure


def test_few_are_wanted_between_two_answers_and_more_where_it_takes_long() -> None:
    until = after((ALL_ROUND, UNSURE))
    assert [until.wanted(taken) for taken in (0, 5, 12, 30, 100)] == [12, 7, 4, 4, 15]
    assert after((ALL_ROUND, sure(HERE))).wanted(100) == 4
