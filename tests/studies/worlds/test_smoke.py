"""One robot in a small room is tried, and the table's words mean what they say."""

from dataclasses import replace

import pytest

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.pose import Pose2
from robotd.sim.buildings.world import load_world
from tests.studies.worlds.trial import Found, _verdict, tried

HERE = Pose2(1.0, 2.0, 0.5)


def test_a_robot_finds_itself_in_the_office() -> None:
    office = load_world("office")
    trial = tried(replace(office, stops_m=office.stops_m[:1], probes_m=(*office.probes_m[:1], (40.0, 40.0))), 3)
    assert (trial.stops, trial.swept) == (2, 2)
    assert [found for found, _ in trial.probes] == [Found.RIGHT, Found.NOT_REACHED]


@pytest.mark.parametrize(
    ("state", "best", "found"),
    [
        (PoseState.LOCALIZED, Pose2(1.2, 2.0, 0.5), Found.RIGHT),
        (PoseState.LOCALIZED, Pose2(5.0, 2.0, 0.5), Found.WRONG_AND_SURE),
        (PoseState.AMBIGUOUS, None, Found.WITHOUT_TRUTH),
        (PoseState.LOST, None, Found.LOST),
    ],
)
def test_what_is_sure_and_elsewhere_is_wrong(state: PoseState, best: Pose2 | None, found: Found) -> None:
    assert _verdict(PoseEstimate(1, state, best, (), 0, 0, True, "m"), HERE) is found
