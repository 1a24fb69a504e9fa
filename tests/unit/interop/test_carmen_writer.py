"""Sweeps as a CARMEN log, whichever way they went round, read by our own reader of such logs."""

import math

import numpy as np
import pytest

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.interop.carmen_writer import PlacedSweep, encode_carmen
from robotd.logs.carmen import parse_carmen

POSE = Pose2(1.25, -2.5, 0.75)


def readings(bearings: list[float]) -> tuple[RangeReading, ...]:
    made = [RangeReading(0, bearing, ReadingStatus.OK, 1.0 + abs(bearing), origin_x_m=0.05) for bearing in bearings]
    made[3] = RangeReading(0, bearings[3], ReadingStatus.MISS, 6.0)
    made[5] = RangeReading(0, bearings[5], ReadingStatus.TIMEOUT, None)
    return tuple(made)


@pytest.mark.parametrize("clockwise", [False, True])
def test_a_sweep_comes_back(clockwise: bool) -> None:
    steps = np.arange(60) * math.radians(6.0) + 2.0
    bearings = [math.remainder(step, math.tau) for step in (steps[::-1] if clockwise else steps)]
    sweep = Sweep(0, Pose2(0.5, 0.0, 0.0), readings(bearings))
    log = parse_carmen(encode_carmen([PlacedSweep(10.0, sweep, POSE), PlacedSweep(12.0, sweep, POSE)]))
    assert log.damaged_lines == 0
    assert [scan.robot_pose for scan in log.scans] == [POSE, POSE]
    [scan, _] = log.scans
    told = {round(math.degrees(math.remainder(angle, math.tau)), 3): at for at, angle in enumerate(scan.angles_rad)}
    for reading in sweep.readings:
        at = told[round(math.degrees(math.remainder(reading.bearing_rad, math.tau)), 3)]
        assert scan.hit[at] == (reading.status is ReadingStatus.OK)
        assert scan.missed[at] == (reading.status is ReadingStatus.MISS)
        if reading.status is ReadingStatus.OK:
            far_m = (reading.range_m or 0.0) + 0.05 * math.cos(reading.bearing_rad)
            assert scan.ranges_m[at] == pytest.approx(far_m)
