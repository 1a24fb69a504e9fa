"""The control laws converge, brake in time and never back up."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.pose import Pose2
from robotd.mission.motion.steering import DrivingSettings, distance_left_m, leg_twist, turn_rate_radps

SETTINGS = DrivingSettings()
PERIOD_S = 0.04


@given(st.floats(-math.pi, math.pi))
def test_turning_converges_without_passing_the_goal(start_rad: float) -> None:
    error = start_rad
    for _ in range(1000):
        error -= turn_rate_radps(error, SETTINGS) * PERIOD_S
        assert abs(error) <= abs(start_rad) + 1e-12
        assert error * start_rad >= 0.0 or abs(error) < 1e-9
    assert abs(error) < SETTINGS.heading_tolerance_rad


@given(st.floats(0.05, 8.0), st.floats(-0.05, 0.05))
def test_a_leg_ends_at_its_end(length_m: float, heading_rad: float) -> None:
    here = Pose2(0.0, 0.0, heading_rad)
    for _ in range(3000):
        if distance_left_m(here, length_m, 0.0) <= SETTINGS.position_tolerance_m:
            break
        twist = leg_twist(here, length_m, 0.0, SETTINGS)
        assert 0.0 <= twist.speed_mps <= SETTINGS.speed_mps
        step = twist.speed_mps * PERIOD_S
        here = Pose2(
            here.x_m + step * math.cos(here.heading_rad),
            here.y_m + step * math.sin(here.heading_rad),
            here.heading_rad + twist.turn_radps * PERIOD_S,
        )
    assert math.hypot(here.x_m - length_m, here.y_m) < SETTINGS.position_tolerance_m + 0.05 * min(length_m, 0.3)


@given(st.floats(0.0, 10.0))
def test_it_can_always_brake_in_the_distance_left(left_m: float) -> None:
    speed = leg_twist(Pose2(0.0, 0.0, 0.0), left_m, 0.0, SETTINGS).speed_mps
    assert speed**2 <= 2.0 * SETTINGS.deceleration_mps2 * left_m + 1e-12


@pytest.mark.parametrize("field", ["speed_mps", "setpoint_ttl_s", "stall_s"])
def test_impossible_settings_are_refused_by_name(field: str) -> None:
    with pytest.raises(ValueError, match=field):
        DrivingSettings(**{field: -1.0})
