"""Sweeps as a CARMEN log, the form that most public laser logs have; :mod:`robotd.logs` reads it."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.interop.fan import BeamFan, from_axis_m

_FAILED = 0.0
"""As the readers of these logs take it: nearer than any scanner measures."""
_REMOTE_TYPE = 99
"""Of a laser, in CARMEN's list of makes: none of them."""


@dataclass(frozen=True, slots=True)
class PlacedSweep:
    """A sweep, when it ended, and where the robot stood."""

    time_s: float
    sweep: Sweep
    pose: Pose2
    """In any one frame: odometry's, or the map's."""


def encode_carmen(sweeps: Iterable[PlacedSweep]) -> Iterator[str]:
    """Yield a log: for each sweep an ``ODOM`` line with odometry, and a ``ROBOTLASER1`` at the pose.

    The form has one laser at one place: each range is told from the robot's axis, along its bearing, so what a head
    beside the axis sees is off by its offset across the beam. Nothing met is told as the largest range of the sweep's
    misses; a failed reading is 0. Sweeps of fewer than two readings are left out.
    """
    begun_s = None
    for placed in sweeps:
        begun_s = placed.time_s if begun_s is None else begun_s
        times = f"{placed.time_s:.6f} robotd {placed.time_s - begun_s:.6f}"
        odom = placed.sweep.in_odom
        yield f"ODOM {_pose(odom)} 0 0 0 {times}\n"
        if len(placed.sweep.readings) >= 2:
            pose = _pose(placed.pose)
            yield f"ROBOTLASER1 {_scan(placed.sweep.readings)} {pose} {pose} 0 0 0 0 0 {times}\n"


def _scan(readings: tuple[RangeReading, ...]) -> str:
    fan = BeamFan.of(readings)
    misses = [from_axis_m(reading) for reading in fan.readings if reading.status is ReadingStatus.MISS]
    limit_m = min(misses, default=0.0)
    count, ranges = len(fan.readings), " ".join(repr(_told_m(reading, limit_m)) for reading in fan.readings)
    fov_rad = fan.step_rad * (count - 1)
    return f"{_REMOTE_TYPE} {fan.first_rad!r} {fov_rad!r} {fan.step_rad!r} {limit_m!r} 0 0 {count} {ranges} 0"


def _told_m(reading: RangeReading, limit_m: float) -> float:
    if reading.range_m is None:
        return _FAILED
    # The limit itself, or more, means that nothing was met: what was met beyond it must not be told so.
    range_m = from_axis_m(reading)
    return limit_m if reading.status is ReadingStatus.MISS else range_m


def _pose(pose: Pose2) -> str:
    return f"{pose.x_m!r} {pose.y_m!r} {pose.heading_rad!r}"
