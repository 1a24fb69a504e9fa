"""A range bias from a wall whose distances are known."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.calibration.range_bias import leg_for
from robotd.calibration.wall_bias import WallSeen, fit_wall, fit_wall_bias
from robotd.core.errors import CalibrationError


def wall(
    distance_m: float, slant_rad: float, bias_m: float, rng: np.random.Generator, sigma_m: float = 0.02
) -> WallSeen:
    """A wall 4 m wide in a round room, one reading in twenty wrong."""
    bearings_rad = np.linspace(-2.7, 2.7, 262)
    across = np.abs(bearings_rad - slant_rad)
    on_it = (across < 1.5) & (distance_m * np.abs(np.tan(bearings_rad - slant_rad)) < 2.0)
    ranges_m = np.where(on_it, distance_m / np.cos(bearings_rad - slant_rad), 2.5 + np.abs(np.sin(3.0 * bearings_rad)))
    ranges_m += rng.normal(0.0, sigma_m, len(ranges_m)) - bias_m
    wrong = rng.random(len(ranges_m)) < 0.05 * (sigma_m > 0.0)
    return WallSeen(distance_m, 0.002, bearings_rad, np.where(wrong, rng.uniform(0.3, 5.0, len(ranges_m)), ranges_m))


@settings(max_examples=60)
@given(
    distance_m=st.floats(0.8, 2.5),
    slant_rad=st.floats(-0.1, 0.1),
    bias_m=st.floats(-0.2, 0.2),
    seed=st.integers(0, 999),
)
def test_the_bias_is_found(distance_m: float, slant_rad: float, bias_m: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    walls = [wall(away_m, slant_rad, bias_m, rng) for away_m in (distance_m, distance_m, 0.6 * distance_m)]
    found = fit_wall_bias(walls)
    assert found.bias_m == pytest.approx(bias_m, abs=0.012)
    assert 0.0005 < found.error_m < 0.006
    assert fit_wall(walls[0]).normal_rad == pytest.approx(slant_rad, abs=0.04)


def test_without_noise_it_is_exact() -> None:
    rng = np.random.default_rng(0)
    found = fit_wall_bias([wall(1.5, 0.05, 0.03, rng, sigma_m=0.0)])
    assert found.bias_m == pytest.approx(0.03, abs=1e-9)


def test_two_distances_that_disagree_widen_the_error() -> None:
    rng = np.random.default_rng(0)
    same = fit_wall_bias([wall(1.5, 0.0, 0.03, rng), wall(0.9, 0.0, 0.03, rng)])
    other = fit_wall_bias([wall(1.5, 0.0, 0.03, rng), wall(0.9, 0.0, 0.08, rng)])
    assert other.error_m > 5.0 * same.error_m


def test_what_is_no_wall_is_refused() -> None:
    bearings_rad, rng = np.linspace(-3.0, 3.0, 300), np.random.default_rng(1)
    with pytest.raises(CalibrationError, match="lie on a flat wall"):
        fit_wall(WallSeen(1.5, 0.002, bearings_rad, rng.uniform(0.5, 4.0, 300)))
    with pytest.raises(CalibrationError, match="nothing is ahead"):
        fit_wall(WallSeen(1.5, 0.002, np.full(40, math.pi), np.ones(40)))


def test_the_second_place_is_nearer_where_there_is_room() -> None:
    assert leg_for(2.0) == 1.0
    assert leg_for(0.9) == pytest.approx(0.4)
    assert leg_for(0.6) == -0.5
