"""Dead reckoning from counts."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.pose import IDENTITY
from robotd.hardware.devices.calibration import DriveCalibration
from robotd.hardware.devices.odometer import Odometer

CALIBRATION = DriveCalibration(counts_per_m=27_300.0, counts_per_rad=4_096.0)


def wrapped(count: int) -> int:
    return (count + 2**31) % 2**32 - 2**31


@settings(max_examples=60)
@given(
    steps=st.lists(st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)), max_size=30),
    start=st.tuples(st.integers(-(2**31), 2**31 - 1), st.integers(-(2**31), 2**31 - 1)),
)
def test_arcs_are_followed_wherever_the_counters_begin_and_wrap(
    steps: list[tuple[float, float]], start: tuple[int, int]
) -> None:
    odometer = Odometer(CALIBRATION)
    odometer.update(1, *start)
    translate, rotate = start
    x = y = heading = 0.0
    for way_m, turn_rad in steps:
        counts_way, counts_turn = round(way_m * 27_300), round(turn_rad * 4_096)
        translate, rotate = translate + counts_way, rotate + counts_turn
        odometer.update(1, wrapped(translate), wrapped(rotate))
        for _ in range(50):  # the slow twin: small straight pieces, each turned a little
            heading += counts_turn / 4_096 / 100
            x += counts_way / 27_300 / 50 * math.cos(heading)
            y += counts_way / 27_300 / 50 * math.sin(heading)
            heading += counts_turn / 4_096 / 100
    assert odometer.in_odom.x_m == pytest.approx(x, abs=2e-7 * len(steps))
    assert odometer.in_odom.y_m == pytest.approx(y, abs=2e-7 * len(steps))
    assert math.cos(odometer.in_odom.heading_rad - heading) == pytest.approx(1.0)


def test_the_origin_is_where_the_base_is_first_seen() -> None:
    assert Odometer(CALIBRATION).update(1, 123_456, -7_890) == IDENTITY


def test_a_restart_of_the_board_makes_no_jump_and_the_way_goes_on() -> None:
    odometer = Odometer(CALIBRATION)
    odometer.update(1, 0, 0)
    before = odometer.update(1, 27_300, 0)
    assert odometer.update(2, 0, 0) == before
    assert odometer.update(2, 27_300, 0).x_m == pytest.approx(2.0)


def test_counts_that_went_on_while_the_link_was_lost_are_not_lost() -> None:
    odometer = Odometer(CALIBRATION)
    odometer.update(1, 0, 0)
    assert odometer.update(1, 273_000, 0).x_m == pytest.approx(10.0)


def test_a_negative_scale_turns_the_sense_round() -> None:
    odometer = Odometer(DriveCalibration(-100.0, -100.0))
    odometer.update(1, 0, 0)
    odometer.update(1, -100, 0)
    assert odometer.update(1, -100, -100).heading_rad == pytest.approx(1.0)
    assert odometer.in_odom.x_m == pytest.approx(1.0)
