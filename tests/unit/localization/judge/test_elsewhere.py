"""Without a map readings are as likely as walls go on straight."""

import math

import numpy as np
from numpy.typing import NDArray

from robotd.grid.readings import Readings
from robotd.localization.judge.elsewhere import elsewhere, going_on
from robotd.localization.judge.error_model import ErrorModel

MODEL = ErrorModel()


def likely_of(readings: Readings) -> NDArray[np.float64]:
    return elsewhere(readings, MODEL, going_on(readings, MODEL))


def along_a_wall(*off_m: float) -> NDArray[np.float64]:
    """Return readings of a wall 2 m ahead, each off by this much."""
    bearings_rad = -0.4 + 0.08 * np.arange(len(off_m))
    zeros = np.zeros(len(off_m))
    return np.column_stack((bearings_rad, 2.0 / np.cos(bearings_rad) + off_m, zeros, zeros, zeros))


def test_a_straight_wall_is_no_surprise() -> None:
    likely = likely_of(Readings(along_a_wall(*[0.0] * 8)))
    assert (likely[2:] > 10 * likely[:2].max()).all()


def test_where_a_wall_goes_on_is_said_with_how_likely_it_is() -> None:
    expected = going_on(Readings(along_a_wall(*[0.0] * 4, 0.3)), MODEL)
    assert expected.is_wall.tolist() == [False, False, True, True, True]
    assert np.allclose(expected.heads_m[2:, 0], 2.0)
    assert expected.densities[4] < 0.01 * expected.densities[3]


def test_what_stands_before_the_wall_is_one_and_the_wall_after_it_too() -> None:
    likely = likely_of(Readings(along_a_wall(0, 0, 0, 0, -0.8, 0, 0, 0)))
    assert likely[4] < 0.1 * likely[3]
    assert likely[5] < 0.2 * likely[3]
    assert likely[7] > 10 * likely[5]


def test_a_miss_is_likely_by_its_range_alone() -> None:
    readings = along_a_wall(*[0.0] * 6)
    readings[4, 4] = 1.0
    assert likely_of(Readings(readings))[4] == math.exp(-MODEL.unknown_per_m * readings[4, 1])


def test_after_a_miss_another_is_no_surprise() -> None:
    readings = along_a_wall(*[0.0] * 6)
    readings[3:5, 4] = 1.0
    likely = likely_of(Readings(readings))
    assert likely[3] < likely[4]
    assert 0.6 < likely[4] < 1.0


def test_one_spot_seen_twice_and_no_readings_at_all_are_no_trouble() -> None:
    twice = np.tile(along_a_wall(0.0), (5, 1))
    assert np.isfinite(likely_of(Readings(twice))).all()
    assert len(likely_of(Readings(twice[:0]))) == 0


def test_turning_the_robot_changes_nothing() -> None:
    readings = along_a_wall(0.0, 0.1, -0.3, 0.0, 0.02, 0.0)
    turned = readings.copy()
    turned[:, 0] += 2.0
    assert np.allclose(likely_of(Readings(readings)), likely_of(Readings(turned)))
