"""Slant geometry against points in space."""

import math

import pytest

from robotd.hardware.devices.slant import floor_m, horizontal_m


@pytest.mark.parametrize("tilt_rad", [-1.2, -0.24, -0.01, 0.0, 0.3, 1.2])
def test_what_is_told_of_a_beam_is_true_of_its_end(tilt_rad: float) -> None:
    height_m, along_m = 0.55, 1.7
    x_m, z_m = along_m * math.cos(tilt_rad), height_m + along_m * math.sin(tilt_rad)
    assert horizontal_m(along_m, tilt_rad) == pytest.approx(x_m)
    # Where the end is above the floor, the floor is farther; and the other way round.
    assert (floor_m(height_m, tilt_rad) > x_m) == (z_m > 0.0)


def test_a_beam_that_does_not_sink_never_meets_the_floor() -> None:
    assert floor_m(0.55, 0.0) == floor_m(0.55, 0.4) == math.inf
