"""Whether a region holds a pose, asked of its extent."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.contract.estimate import Extent
from robotd.core.pose import Pose2

HERE = Extent(1.0, 2.0, -1.0, 3.0, 3.0, 3.5)
"""Its headings go on over pi."""


@pytest.mark.parametrize(
    ("pose", "is_held"),
    [
        (Pose2(1.0, 3.0, 3.0), True),
        (Pose2(1.5, 0.0, 3.4 - math.tau), True),
        (Pose2(0.99, 0.0, 3.2), False),
        (Pose2(1.5, 3.01, 3.2), False),
        (Pose2(1.5, 0.0, 2.99), False),
        (Pose2(1.5, 0.0, 3.51 - math.tau), False),
    ],
)
def test_a_pose_is_held_up_to_the_sides(pose: Pose2, is_held: bool) -> None:
    assert HERE.holds(pose) is is_held


@given(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.floats(-3.1, 3.1), st.floats(0.0, 3.0), st.floats(0.0, 2.0))
def test_near_moves_the_sides_outward(
    x_m: float, y_m: float, turned_rad: float, near_m: float, near_rad: float
) -> None:
    inside = 1.0 - near_m <= x_m <= 2.0 + near_m and -1.0 - near_m <= y_m <= 3.0 + near_m
    slack_m = min(abs(off) for off in (x_m - 1.0 + near_m, x_m - 2.0 - near_m, y_m + 1.0 + near_m, y_m - 3.0 - near_m))
    is_turned_there = abs(turned_rad) <= 0.25 + near_rad
    if slack_m < 1e-9 or abs(abs(turned_rad) - 0.25 - near_rad) < 1e-9:
        return
    pose = Pose2(x_m, y_m, 3.25 + turned_rad)
    assert HERE.holds(pose, near_m=near_m, near_rad=near_rad) is (inside and is_turned_there)


def test_all_round_holds_every_heading() -> None:
    all_round = Extent(0.0, 1.0, 0.0, 1.0, -1.0, -1.0 + math.tau)
    assert all(all_round.holds(Pose2(0.5, 0.5, k * 0.1)) for k in range(-40, 40))
