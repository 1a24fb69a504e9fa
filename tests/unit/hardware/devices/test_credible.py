"""What passes the gate between a device and SI values, and what is a fault of its device."""

import math

import pytest

from robotd.core.clock import NS_PER_S
from robotd.core.errors import DeviceError
from robotd.core.pose import Twist2
from robotd.hardware.devices import credible
from robotd.hardware.devices.calibration import DriveCalibration
from robotd.hardware.devices.credible import Times
from robotd.hardware.devices.odometer import JudgedOdometer
from robotd.hardware.devices.pantilt import AimReadback, PanTiltLimits

S = NS_PER_S
refused = pytest.raises(DeviceError, match="implausible")


@pytest.mark.parametrize("twist", [Twist2(0.9, 0.0), Twist2(-2.0, -3.0), Twist2(0.0, 19.9)])
def test_what_a_base_can_do_passes(twist: Twist2) -> None:
    credible.check_twist("drive", twist)


@pytest.mark.parametrize(
    "twist", [Twist2(32.767, 0.0), Twist2(0.0, -32.768), Twist2(math.nan, 0.0), Twist2(0.0, math.inf)]
)
def test_no_base_moves_so(twist: Twist2) -> None:
    with refused:
        credible.check_twist("drive", twist)


@pytest.mark.parametrize(("pan_rad", "tilt_rad"), [(0.1, 0.0), (0.1 - math.tau, 0.02), (0.0, -0.1)])
def test_a_head_rests_about_where_it_was_told_to_the_long_way_round_too(pan_rad: float, tilt_rad: float) -> None:
    credible.check_readback("pantilt", AimReadback(0, pan_rad, tilt_rad), 0.1, 0.0)


@pytest.mark.parametrize(
    ("pan_rad", "tilt_rad"), [(0.1, 200_000.0), (0.1, math.nan), (2.0, 0.0), (214_748.3647, 0.0), (0.1, -1.6)]
)
def test_no_head_rests_there(pan_rad: float, tilt_rad: float) -> None:
    with refused:
        credible.check_readback("pantilt", AimReadback(0, pan_rad, tilt_rad), 0.1, 0.0)


@pytest.mark.parametrize(
    "limits",
    [
        (1.0, -1.0, 0.0, 0.0),
        (-1.0, 1.0, 1.0, 0.0),
        (-1.0, 1.0, -9e4, 9e4),
        (-1.0, 1.0, math.nan, 1.0),
        (-9e4, 1.0, 0, 0),
    ],
)
def test_no_head_has_such_limits(limits: tuple[float, float, float, float]) -> None:
    with refused:
        credible.check_limits("pantilt", PanTiltLimits(*limits))
    credible.check_limits("pantilt", PanTiltLimits(-math.pi, math.pi, -0.5, 0.5))


@pytest.mark.parametrize("volts", [-0.1, 151.0, 429_496_729.5, math.nan])
def test_no_battery_has_such_a_voltage(volts: float) -> None:
    with refused:
        credible.battery_v("drive", volts)
    assert credible.battery_v("drive", 48.0) == 48.0
    assert credible.battery_v("drive", 0.0) is None


def test_a_time_lies_neither_ahead_of_when_it_was_heard_nor_minutes_behind() -> None:
    times = Times("drive", 1.0)
    times.check(100 * S, 100 * S)
    times.check(95 * S, 100 * S)
    for time_ns in (101 * S, 2**64 * 1000, 0, -(2**70)):
        with refused:
            times.check(time_ns, 100 * S)


def test_what_was_kept_in_buffers_through_a_stall_is_late_and_believed() -> None:
    times = Times("drive", 1.0)
    for late_ms in range(3000, 0, -40):  # all of it comes at once
        times.check_periodic(100 * S - late_ms * 1_000_000, 100 * S)
    times.check_periodic(102 * S, 102 * S)


def test_a_clock_that_stands_or_falls_behind_is_told_within_two_seconds() -> None:
    times = Times("drive", 1.0)
    for heard_ms in range(0, 1520, 40):
        times.check_periodic(100 * S, 100 * S + heard_ms * 1_000_000)
    with pytest.raises(DeviceError, match="falls behind"):
        times.check_periodic(100 * S, 100 * S + 1_600_000_000)


def test_a_clock_may_stay_behind_for_as_long_as_its_device_may_be_silent() -> None:
    times = Times("drive", 10.0)  # a simulated robot on a busy machine
    for heard_ms in range(0, 10_500, 40):
        times.check_periodic(100 * S, 100 * S + heard_ms * 1_000_000)
    with pytest.raises(DeviceError, match="falls behind"):
        times.check_periodic(100 * S, 110 * S + 600_000_000)


def test_while_we_stand_still_again_and_again_no_clock_falls_behind_and_soon_after_it_does() -> None:
    times = Times("drive", 1.0)
    for heard_ms in range(0, 5000, 40):
        times.check_periodic(100 * S, 101 * S + heard_ms * 1_000_000, missed_s=heard_ms // 400 * 0.2)
    times.check_periodic(100 * S, 106 * S, missed_s=2.4)
    with pytest.raises(DeviceError, match="falls behind"):
        times.check_periodic(100 * S, 107 * S + S // 10, missed_s=2.4)


def test_a_jump_of_the_counts_is_left_out_and_what_is_true_goes_on() -> None:
    odometer = JudgedOdometer("drive", DriveCalibration(1000.0, 1000.0))
    odometer.update(1, 0, 0, 0)
    odometer.update(1, 10, 0, S)
    for counts in ((2**31 - 1, 0), (10, -(2**31)), (20_000, 0)):
        with refused:
            odometer.update(1, *counts, S + 40_000_000)
    assert odometer.update(1, 20, 0, S + 80_000_000).x_m == pytest.approx(0.02)


def test_counts_that_jumped_for_good_are_believed_once_somebody_has_looked() -> None:
    odometer = JudgedOdometer("drive", DriveCalibration(1000.0, 1000.0))
    odometer.update(1, 1000, 0, S)
    odometer.update(1, 2000, 0, 2 * S)
    with refused:
        odometer.update(1, 900_000, 0, 3 * S)
    odometer.start_again()
    assert odometer.update(1, 900_000, 0, 4 * S).x_m == pytest.approx(1.0)
    assert odometer.update(1, 901_000, 0, 5 * S).x_m == pytest.approx(2.0)


def test_counts_that_went_on_through_a_minute_without_a_line_are_not_lost() -> None:
    odometer = JudgedOdometer("drive", DriveCalibration(1000.0, 1000.0))
    odometer.update(1, 0, 0, 0)
    assert odometer.update(1, 30_000, 0, 60 * S).x_m == pytest.approx(30.0)
