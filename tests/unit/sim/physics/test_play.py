"""The play of the pan gears: the beam stays until the motor has turned through it."""

import math

import pytest

from robotd.sim.physics.steppers import StepperHead, StepperSettings

PLAY_RAD = 0.1


def turned(head: StepperHead, at_us: int, *pans_rad: float) -> tuple[float, int]:
    """Turn to each in turn and return where the beam points at last, and when."""
    for pan_rad in pans_rad:
        head.advance(at_us)
        head.aim(pan_rad, 0.0)
        at_us += 3_000_000
        head.advance(at_us)
    return head.beam_rad[0], at_us


@pytest.mark.parametrize("limit_rad", [2.5, math.pi])
def test_the_beam_lags_by_half_the_play_on_either_side(limit_rad: float) -> None:
    head = StepperHead(StepperSettings(backlash_rad=PLAY_RAD, pan_limit_rad=limit_rad))
    there, at_us = turned(head, 0, 1.0)
    assert there == pytest.approx(1.0 - PLAY_RAD / 2, abs=0.001)
    within, at_us = turned(head, at_us, 0.95)
    assert within == there
    back, at_us = turned(head, at_us, 0.5)
    assert back == pytest.approx(0.5 + PLAY_RAD / 2, abs=0.001)
    assert head.angles_rad[0] == pytest.approx(0.5, abs=0.001)


def test_an_endless_head_keeps_its_lag_across_the_half_turn() -> None:
    head = StepperHead(StepperSettings(backlash_rad=PLAY_RAD, pan_limit_rad=math.pi))
    there, _ = turned(head, 0, 3.0, -3.0)
    assert math.remainder(there - (-3.0 - PLAY_RAD / 2), math.tau) == pytest.approx(0.0, abs=0.001)


def test_without_play_the_beam_is_where_the_motor_is() -> None:
    head = StepperHead(StepperSettings())
    turned(head, 0, 1.0, -0.3)
    assert head.beam_rad == head.true_angles_rad
