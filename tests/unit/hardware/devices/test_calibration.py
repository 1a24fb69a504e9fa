"""From what the instruments say to the robot frame."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.pose import Pose2
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.calibration import DriveCalibration, HeadMount, RangefinderCalibration
from robotd.hardware.devices.pantilt import AimReadback
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.reading_in_robot import reading_in_robot

CALIBRATION = RangefinderCalibration()


def hit(range_m: float) -> Shot:
    return Shot(7, ReadingStatus.OK, range_m, 100)


def level(pan_rad: float) -> AimReadback:
    return AimReadback(5, pan_rad, 0.0)


def test_a_level_hit_keeps_its_range_bearing_time_and_strength() -> None:
    reading = reading_in_robot(HeadMount(), CALIBRATION, level(0.5), hit(2.0))
    assert (reading.time_ns, reading.bearing_rad, reading.range_m, reading.strength) == (7, 0.5, 2.0, 100)
    assert (reading.origin_x_m, reading.origin_y_m) == (0.0, 0.0)


def test_a_slanted_range_is_made_horizontal() -> None:
    reading = reading_in_robot(HeadMount(), CALIBRATION, AimReadback(5, 0.0, math.radians(-60)), hit(4.0))
    assert reading.range_m == pytest.approx(2.0)


def test_the_beam_begins_at_the_pan_axis() -> None:
    reading = reading_in_robot(HeadMount(x_m=0.1, y_m=-0.05), CALIBRATION, level(0.0), hit(2.0))
    assert (reading.origin_x_m, reading.origin_y_m) == (0.1, -0.05)


@pytest.mark.parametrize(
    ("shot", "status", "range_m"),
    [
        (hit(6.0), ReadingStatus.OK, 6.0),
        (hit(6.001), ReadingStatus.MISS, 6.0),
        (Shot(7, ReadingStatus.MISS, None, 0), ReadingStatus.MISS, 6.0),
        (hit(0.3), ReadingStatus.OK, 0.3),
        (hit(0.299), ReadingStatus.TOO_NEAR, None),
        (hit(-0.1), ReadingStatus.TOO_NEAR, None),
        (Shot(7, ReadingStatus.WEAK, None, 3), ReadingStatus.WEAK, None),
        (Shot(7, ReadingStatus.TIMEOUT, None, None), ReadingStatus.TIMEOUT, None),
    ],
)
def test_what_counts_as_met_not_met_and_not_measured(shot: Shot, status: ReadingStatus, range_m: float | None) -> None:
    reading = reading_in_robot(HeadMount(), CALIBRATION, level(0.0), shot)
    assert (reading.status, reading.range_m) == (status, range_m)


def test_the_cut_off_is_horizontal() -> None:
    slanted = AimReadback(5, 0.0, math.radians(-30))
    assert reading_in_robot(HeadMount(), CALIBRATION, slanted, hit(6.5)).status is ReadingStatus.OK
    assert reading_in_robot(HeadMount(), CALIBRATION, slanted, hit(7.0)).status is ReadingStatus.MISS


@settings(max_examples=60)
@given(
    pan=st.floats(-4, 4),
    range_m=st.floats(0.5, 5.9),
    turn=st.floats(-4, 4),
    x=st.floats(-0.3, 0.3),
    y=st.floats(-0.3, 0.3),
)
def test_the_same_obstacle_is_found_from_a_turned_base(
    pan: float, range_m: float, turn: float, x: float, y: float
) -> None:
    # The slow twin: take the end of the beam through every frame, point by point.
    mount, base = HeadMount(x, y), Pose2(0.01, -0.02, turn)
    in_base = Pose2(x, y, pan).transform(range_m, 0.0)
    expected = base.transform(*in_base)
    reading = reading_in_robot(mount, CALIBRATION, level(pan), hit(range_m), base)
    assert reading.range_m is not None
    found = Pose2(reading.origin_x_m, reading.origin_y_m, reading.bearing_rad).transform(reading.range_m, 0.0)
    assert found == pytest.approx(expected, abs=1e-9)
    assert -math.pi <= reading.bearing_rad < math.pi


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: DriveCalibration(0.0, 1.0), "counts_per_m must be 100 to 1e\\+08 counts/m, of either sign, got 0"),
        (
            lambda: DriveCalibration(1000.0, math.nan),
            "counts_per_rad must be 10 to 1e",
        ),
        (lambda: HeadMount(x_m=11.0), "x_m must be -3 to 3 m, got 11"),
        (lambda: HeadMount(tilt_zero_rad=math.inf), "tilt_zero_rad must be -3.14159 to 3.14159 rad, got inf"),
        (lambda: RangefinderCalibration(range_min_m=-1), "range_min_m must be 0.001 to 20 m, got -1"),
        (lambda: RangefinderCalibration(range_max_m=0.2), "range_max_m must be above range_min_m, got 0.2"),
        (lambda: RangefinderCalibration(range_bias_m=math.nan), "range_bias_m must be -1 to 1 m, got nan"),
    ],
)
def test_impossible_values_are_refused_by_name(make: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()
