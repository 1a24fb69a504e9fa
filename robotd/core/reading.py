"""One laser measurement, and the 300 of them that are taken at a stop.

The paper calls a measurement a *probe*, a vector with its tail at the robot and its head at an
obstacle ([BrownDonald2000]_ sec. 2.2). Here it is a :class:`RangeReading`; 300 make a :class:`Sweep`.
"""

import enum
import math
from collections.abc import Iterable
from dataclasses import dataclass

from robotd.core.pose import IDENTITY, Pose2


class ReadingStatus(enum.StrEnum):
    """What became of one shot. Never a sentinel number in place of a range."""

    OK = "ok"
    MISS = "miss"
    """Over-range: the beam met nothing up to the cut-off."""
    TOO_NEAR = "too_near"
    WEAK = "weak"
    SATURATED = "saturated"
    AMBIENT = "ambient"
    NOT_MEASURED = "not_measured"
    """The instrument cannot see in this direction."""
    TIMEOUT = "timeout"
    DEVICE_ERROR = "device_error"


@dataclass(frozen=True, slots=True)
class RangeReading:
    """One horizontal range measurement, in the frame of the robot at its stop."""

    time_ns: int
    """When the light was sent, monotonic clock of this host [ns]."""
    bearing_rad: float
    """Direction of the beam in the robot frame, counter-clockwise from its heading."""
    status: ReadingStatus
    range_m: float | None
    """Horizontal distance from ``(origin_x_m, origin_y_m)`` to the obstacle; for a miss, the
    cut-off up to which nothing was met; None for every other status."""
    strength: int | None = None
    """Signal strength as the device counts it."""
    origin_x_m: float = 0.0
    """Where the beam starts, in the robot frame."""
    origin_y_m: float = 0.0

    def __post_init__(self) -> None:
        """Refuse a reading whose range and status contradict each other."""
        measured = self.status in {ReadingStatus.OK, ReadingStatus.MISS}
        if measured != (self.range_m is not None):
            raise ValueError(f"a {self.status} reading has range {self.range_m}")
        if self.range_m is not None and not (math.isfinite(self.range_m) and self.range_m > 0.0):
            raise ValueError(f"range must be finite and positive, got {self.range_m}")

    @property
    def is_measured(self) -> bool:
        """Whether the reading says something about the room: a hit or a miss."""
        return self.range_m is not None


@dataclass(frozen=True, slots=True)
class Tilt:
    """A further tilt of the beam, beside that of the first look round: a layer of the map is what is seen at it."""

    tilt_rad: float
    """Up from level."""
    cut_off_m: float
    """What is horizontally farther than this counts as not met: the floor must lie beyond it."""


@dataclass(frozen=True, slots=True)
class Slant:
    """What was seen at a further tilt, all the way round."""

    tilt: Tilt
    readings: tuple[RangeReading, ...]


@dataclass(frozen=True, slots=True, repr=False)
class Sweep:
    """The readings of one stop, evenly round the robot, all in the robot frame of ``in_odom``."""

    number: int
    """Counts the sweeps of this run of the daemon."""
    in_odom: Pose2
    """Where the robot stood, by odometry, when the sweep began."""
    readings: tuple[RangeReading, ...]
    """Of the first look round, mostly a level one."""
    slants: tuple[Slant, ...] = ()
    """What was seen at further tilts, if the robot looked so: they are of other layers of the map."""

    @classmethod
    def of(cls, bearings_rad: Iterable[float], ranges_m: Iterable[float], cutoff_m: float) -> "Sweep":
        """Return the sweep of a scanner that stands where the robot stands, from two columns of equal length.

        Ranges are read as ROS's REP 117 says: infinite, or not nearer than the cut-off, means that nothing was met up
        to there; NaN that nothing was measured; zero or less, too near.

        Raises:
            ValueError: the columns differ in length, a bearing is not finite, or the cut-off is not positive.

        >>> Sweep.of([0.0, 0.1, 0.2], [1.5, math.inf, math.nan], cutoff_m=6.0)
        Sweep(3 readings: 1 ok, 1 miss, 1 not_measured)
        """
        if not (math.isfinite(cutoff_m) and cutoff_m > 0.0):
            raise ValueError(f"cutoff_m must be positive, got {cutoff_m}")
        beams = zip(map(float, bearings_rad), map(float, ranges_m), strict=True)
        return cls(0, IDENTITY, tuple(_reading(*beam, float(cutoff_m)) for beam in beams))

    def __repr__(self) -> str:
        """Say how many readings there are of each kind: three hundred of them in full tell nobody anything."""
        counts = ((self.count(status), status) for status in ReadingStatus)
        told = ", ".join(f"{count} {status}" for count, status in counts if count)
        return f"Sweep({len(self.readings)} readings{': ' if told else ''}{told})"

    def at(self, slant: Slant) -> "Sweep":
        """Return what was seen at a further tilt as a sweep of its own, taken in the same place."""
        return Sweep(self.number, self.in_odom, slant.readings)

    @property
    def is_clockwise(self) -> bool:
        """Whether the head went round clockwise."""
        return goes_clockwise(self.number)

    def count(self, status: ReadingStatus) -> int:
        """Return how many readings ended with this status."""
        return sum(reading.status is status for reading in self.readings)

    @property
    def measured(self) -> tuple[RangeReading, ...]:
        """The hits and misses, in order."""
        return tuple(reading for reading in self.readings if reading.range_m is not None)


def _reading(bearing_rad: float, range_m: float, cutoff_m: float) -> RangeReading:
    if not math.isfinite(bearing_rad):
        raise ValueError(f"bearings must be finite, got {bearing_rad}")
    if math.isnan(range_m):
        return RangeReading(0, bearing_rad, ReadingStatus.NOT_MEASURED, None)
    if range_m <= 0.0:
        return RangeReading(0, bearing_rad, ReadingStatus.TOO_NEAR, None)
    # At the cut-off, not at where the sensor ends: beyond it nothing was asked.
    if range_m >= cutoff_m:
        return RangeReading(0, bearing_rad, ReadingStatus.MISS, cutoff_m)
    return RangeReading(0, bearing_rad, ReadingStatus.OK, range_m)


def goes_clockwise(number: int) -> bool:
    """Return whether the head goes clockwise in a sweep of this number: they take turns at it."""
    return number % 2 == 1
