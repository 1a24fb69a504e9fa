"""Slant geometry against points in space, turned by matrices."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.hardware.devices.calibration import HeadMount
from robotd.hardware.devices.slant import slanted_beam

HEAD = HeadMount(height_m=0.55)


def in_space(mount: HeadMount, pan_rad: float, tilt_rad: float, along_m: float) -> NDArray[np.float64]:
    """Return where a beam is after some way, robot frame: turned about the tilt axis, and then about the pan axis."""
    tilted = np.array(
        [
            [math.cos(tilt_rad), 0.0, -math.sin(tilt_rad)],
            [0.0, 1.0, 0.0],
            [math.sin(tilt_rad), 0.0, math.cos(tilt_rad)],
        ]
    )
    panned = np.array(
        [
            [math.cos(pan_rad), -math.sin(pan_rad), 0.0],
            [math.sin(pan_rad), math.cos(pan_rad), 0.0],
            [0.0, 0.0, 1.0],
        ]
    )
    # Level, the lens is at the height of the beam: the axis lies below it by as much as the lens is above that.
    axis = np.array([mount.x_m, mount.y_m, mount.height_m - mount.lens_up_m])
    found: NDArray[np.float64] = axis + panned @ tilted @ np.array([mount.lens_ahead_m + along_m, 0.0, mount.lens_up_m])
    return found


OFFSETS = st.floats(-0.3, 0.3)


@given(
    st.builds(HeadMount, x_m=OFFSETS, y_m=OFFSETS, height_m=st.just(0.55), lens_ahead_m=OFFSETS, lens_up_m=OFFSETS),
    st.floats(-math.pi, math.pi),
    st.floats(-1.2, 1.2),
    st.floats(0.1, 20.0),
)
def test_what_is_told_of_a_beam_is_true_of_its_ends(
    mount: HeadMount, pan_rad: float, tilt_rad: float, along_m: float
) -> None:
    beam = slanted_beam(mount, pan_rad, tilt_rad)
    start, end = in_space(mount, pan_rad, tilt_rad, 0.0), in_space(mount, pan_rad, tilt_rad, along_m)
    assert (beam.start_x_m, beam.start_y_m, beam.start_z_m) == pytest.approx(tuple(start))
    way_m = beam.per_m * along_m
    assert (start[0] + way_m * math.cos(pan_rad), start[1] + way_m * math.sin(pan_rad)) == pytest.approx(end[:2])
    if math.isfinite(beam.floor_m):
        on_floor = in_space(mount, pan_rad, tilt_rad, beam.floor_m / beam.per_m)
        assert on_floor[2] == pytest.approx(0.0, abs=1e-9)
    else:
        assert tilt_rad > -1e-300  # or it sinks so little that no number tells how far off the floor is


def test_a_beam_that_does_not_sink_never_meets_the_floor_nor_one_of_a_head_that_was_not_measured() -> None:
    assert slanted_beam(HEAD, 0.3, 0.0).floor_m == slanted_beam(HEAD, 0.3, 0.4).floor_m == math.inf
    assert slanted_beam(HeadMount(), 0.3, -0.4).floor_m == math.inf


def test_lilys_beam_meets_the_floor_a_little_beyond_two_metres() -> None:
    assert slanted_beam(HEAD, 0.0, -0.24).floor_m == pytest.approx(2.25, abs=0.01)


def test_a_lens_ahead_of_its_axes_goes_round_them() -> None:
    mount = HeadMount(x_m=0.1, height_m=0.5, lens_ahead_m=0.05)
    left = slanted_beam(mount, math.pi / 2, 0.0)
    assert (left.start_x_m, left.start_y_m, left.start_z_m) == pytest.approx((0.1, 0.05, 0.5))
    down = slanted_beam(mount, 0.0, -math.pi / 2)
    assert (down.start_x_m, down.start_z_m) == pytest.approx((0.1, 0.45))
