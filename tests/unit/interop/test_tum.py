"""Trajectories come back as they went, and what is no trajectory is refused by its line."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.interop.tum import TimedPose, encode_tum
from tests.support.tum_reader import decode_tum

coordinates = st.floats(-1e6, 1e6)
timed_poses = st.builds(
    TimedPose,
    st.integers(0, 2**31 * 1000).map(lambda ms: ms / 1000),
    st.builds(Pose2, coordinates, coordinates, st.floats(-math.pi, math.pi)),
)


@given(st.lists(timed_poses, max_size=5))
def test_poses_come_back(poses: list[TimedPose]) -> None:
    back = list(decode_tum("".join(encode_tum(poses)).splitlines()))
    for one, other in zip(poses, back, strict=True):
        assert abs(one.time_s - other.time_s) <= 1e-6
        assert (one.pose.x_m, one.pose.y_m) == (other.pose.x_m, other.pose.y_m)
        assert abs(math.remainder(one.pose.heading_rad - other.pose.heading_rad, math.tau)) < 1e-9


def test_others_write_comments_and_any_length_of_quaternion() -> None:
    [timed] = decode_tum(["# timestamp tx ty tz qx qy qz qw", "", "1.5 1 2 0.3 0 0 2 2"])
    assert (timed.time_s, timed.pose.x_m, timed.pose.y_m) == (1.5, 1.0, 2.0)
    assert timed.pose.heading_rad == pytest.approx(math.pi / 2)


@pytest.mark.parametrize(
    "line", ["1 2 3", "1 2 3 4 5 6 7 x", "1 2 3 4 0 0 0 0", "nan 1 2 0 0 0 0 1", "1 2 3 4 5 6 7 8 9"]
)
def test_damage_is_named_by_its_line(line: str) -> None:
    with pytest.raises(RecordingError, match=r"line 2: .*"):
        list(decode_tum(["0 0 0 0 0 0 0 1", line]))
