import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.sim.physics.steppers import StepperHead, StepperSettings

STEP_RAD = StepperSettings().step_rad


def test_it_takes_its_time_and_says_beforehand_how_long() -> None:
    head = StepperHead(StepperSettings())
    head.advance(1_000_000)
    head.aim(1.2, -0.3)
    assert head.arrives_us == pytest.approx(1_200_000, abs=200)
    head.advance(1_100_000)
    assert head.angles_rad == pytest.approx((0.6, -0.3), abs=STEP_RAD)
    arrives_us = head.arrives_us
    assert arrives_us is not None
    head.advance(arrives_us)
    assert head.arrives_us is None
    assert head.angles_rad == head.true_angles_rad == pytest.approx((1.2, -0.3), abs=STEP_RAD)


@given(st.floats(-2.7, 2.7), st.floats(-0.8, 0.5))
def test_it_rests_on_the_nearest_step_and_reads_back_where_it_rests(pan_rad: float, tilt_rad: float) -> None:
    head = StepperHead(StepperSettings())
    head.aim(pan_rad, tilt_rad)
    head.advance(2_000_000)
    for found, aimed in zip(head.angles_rad, (pan_rad, tilt_rad), strict=True):
        assert abs(found - aimed) <= STEP_RAD / 2 + 1e-12
        assert found / STEP_RAD == pytest.approx(round(found / STEP_RAD), abs=1e-6)
    assert head.angles_rad == head.true_angles_rad


@given(st.lists(st.integers(1, 400_000), max_size=12))
def test_how_time_is_cut_changes_nothing(looks_us: list[int]) -> None:
    straight, looked_at = StepperHead(StepperSettings()), StepperHead(StepperSettings())
    for head in (straight, looked_at):
        head.aim(2.0, 0.4)
    for look_us in sorted(looks_us):
        looked_at.advance(look_us)
    for head in (straight, looked_at):
        head.advance(400_000)
    assert straight.true_angles_rad == looked_at.true_angles_rad
    assert straight.arrives_us == looked_at.arrives_us


def test_a_new_aim_starts_from_where_the_old_one_had_got_to() -> None:
    head = StepperHead(StepperSettings())
    head.aim(2.0, 0.0)
    head.advance(100_000)
    head.aim(0.0, 0.0)
    assert head.true_angles_rad[0] == pytest.approx(0.6, abs=1e-6)
    assert head.arrives_us == pytest.approx(200_000, abs=200)


def test_halted_it_stays_where_it_is() -> None:
    head = StepperHead(StepperSettings())
    head.aim(2.0, 0.0)
    head.advance(100_000)
    head.halt()
    head.advance(5_000_000)
    assert head.arrives_us is None
    assert head.angles_rad[0] == pytest.approx(0.6, abs=STEP_RAD)


def test_a_limited_head_goes_back_the_long_way_and_an_endless_one_the_short_way() -> None:
    limited, endless = StepperHead(StepperSettings()), StepperHead(StepperSettings(pan_limit_rad=math.pi))
    for head in (limited, endless):
        head.aim(2.7, 0.0)
        head.advance(1_000_000)
        head.aim(-2.7, 0.0)
    assert limited.arrives_us == pytest.approx(1_900_000, abs=200)
    assert endless.arrives_us == pytest.approx(1_000_000 + (math.tau - 5.4) / 6.0 * 1e6, abs=400)
    endless.advance(1_100_000)
    assert -math.pi <= endless.angles_rad[0] <= math.pi
    endless.advance(2_000_000)
    assert endless.angles_rad[0] == pytest.approx(-2.7, abs=STEP_RAD)


def test_its_limits_are_those_of_the_settings() -> None:
    assert StepperHead(StepperSettings()).limits_rad[:2] == (-math.radians(159), math.radians(159))
    assert StepperHead(StepperSettings(pan_limit_rad=7.0)).limits_rad[:2] == (-math.pi, math.pi)


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(ValueError, match="speed_radps must be positive"):
        StepperSettings(speed_radps=0.0)
    with pytest.raises(ValueError, match="tilt_min_rad"):
        StepperSettings(tilt_min_rad=0.1)
