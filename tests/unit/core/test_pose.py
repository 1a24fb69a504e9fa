"""Poses compose as rigid motions do."""

import math

from hypothesis import given
from hypothesis import strategies as st

from robotd.core.angles import wrap_rad
from robotd.core.pose import IDENTITY, Pose2

coordinates = st.floats(-100.0, 100.0)
poses = st.builds(Pose2, coordinates, coordinates, st.floats(-math.pi, math.pi))


def close(a: Pose2, b: Pose2) -> bool:
    return a.distance_m(b) < 1e-9 * 1000 and abs(wrap_rad(a.heading_rad - b.heading_rad)) < 1e-9


@given(poses)
def test_a_pose_after_its_inverse_is_the_identity(pose: Pose2) -> None:
    assert close(pose @ pose.inverse(), IDENTITY)
    assert close(pose.inverse() @ pose, IDENTITY)


@given(poses, poses, poses)
def test_composition_is_associative(a: Pose2, b: Pose2, c: Pose2) -> None:
    assert close((a @ b) @ c, a @ (b @ c))


@given(poses, coordinates, coordinates)
def test_the_inverse_takes_a_point_back(pose: Pose2, x_m: float, y_m: float) -> None:
    back = pose.inverse().transform(*pose.transform(x_m, y_m))
    assert math.dist(back, (x_m, y_m)) < 1e-9 * 1000


@given(st.floats(-1000.0, 1000.0))
def test_wrapping_keeps_the_direction_and_the_interval(angle_rad: float) -> None:
    wrapped = wrap_rad(angle_rad)
    assert -math.pi <= wrapped < math.pi
    assert math.isclose(math.cos(wrapped), math.cos(angle_rad), abs_tol=1e-9)
    assert math.isclose(math.sin(wrapped), math.sin(angle_rad), abs_tol=1e-9)
