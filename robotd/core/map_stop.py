"""A stop of a map: what was seen there, and where on the map that was.

Its readings are kept as one array: a map of a thousand stops would be some hundred thousand objects otherwise, and
whenever Python looks for garbage among them the event loop waits.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Slant, Sweep, Tilt

STATUSES = tuple(ReadingStatus)
READING = np.dtype(
    [
        ("time_ns", "<i8"),
        ("bearing_rad", "<f8"),
        ("range_m", "<f8"),
        ("origin_x_m", "<f8"),
        ("origin_y_m", "<f8"),
        ("strength", "<i8"),
        ("status", "u1"),
        ("has_strength", "?"),
    ]
)
"""The fields of a :class:`RangeReading`; ``status`` counts :data:`STATUSES`, and what is None there is 0 here."""
_OK, _MISS = STATUSES.index(ReadingStatus.OK), STATUSES.index(ReadingStatus.MISS)
_CODES = {status: code for code, status in enumerate(STATUSES)}


@dataclass(frozen=True, slots=True, eq=False)
class StopSlant:
    """What was seen from a stop at a further tilt."""

    tilt: Tilt
    readings: NDArray[np.void]
    """As those of :class:`MapStop`."""


@dataclass(frozen=True, slots=True, eq=False)
class MapStop:
    """A sweep and its place on a map.

    How the head was mounted and tilted is in the readings: each is level, and says where its beam starts.
    """

    number: int
    in_odom: Pose2
    """Where the robot stood, by odometry."""
    map_from_robot: Pose2
    """Where it stood."""
    readings: NDArray[np.void]
    """Of type :data:`READING`, in the order in which they were made; robot frame. Never changed."""
    slants: tuple[StopSlant, ...] = ()
    """Those of other layers of the map."""

    @classmethod
    def of(cls, sweep: Sweep, map_from_robot: Pose2) -> "MapStop":
        """Return a sweep that was taken at a pose.

        Raises:
            OverflowError: a number of it needs more than 64 bits.
        """
        slants = tuple(StopSlant(slant.tilt, _array(slant.readings)) for slant in sweep.slants)
        return cls(sweep.number, sweep.in_odom, map_from_robot, _array(sweep.readings), slants)

    @property
    def sweep(self) -> Sweep:
        """What was seen, as it was when it was taken."""
        slants = tuple(Slant(slant.tilt, _readings(slant.readings)) for slant in self.slants)
        return Sweep(self.number, self.in_odom, _readings(self.readings), slants)

    def at(self, tilt_rad: float) -> "MapStop | None":
        """Return what was seen here at a further tilt as a stop of its own; None if the robot did not look so."""
        for slant in self.slants:
            if slant.tilt.tilt_rad == tilt_rad:
                return MapStop(self.number, self.in_odom, self.map_from_robot, slant.readings)
        return None

    def beams(self, *, misses: bool) -> NDArray[np.float64]:
        """Return the hits, and the misses if they are asked for, as :class:`robotd.grid.readings.Readings` has them.

        ``float64[n, 5]``: bearing [rad], range [m], x and y of the beam's start [m], and 1 for a miss, 0 for a hit.
        """
        status = self.readings["status"]
        here = self.readings[(status == _OK) | (status == _MISS) if misses else status == _OK]
        columns = [here[name] for name in ("bearing_rad", "range_m", "origin_x_m", "origin_y_m")]
        return np.stack((*columns, here["status"] == _MISS), axis=1, dtype=np.float64)

    def __eq__(self, other: object) -> bool:
        """Return whether both are the same, bit for bit."""
        if not isinstance(other, MapStop):
            return NotImplemented
        return self._content == other._content

    def __hash__(self) -> int:
        """Return the same for what is the same."""
        return hash(self._content)

    @property
    def _content(self) -> tuple[object, ...]:
        # As bytes: NaN is not equal to itself, and a map is the same if its bits are.
        slants = tuple((slant.tilt, slant.readings.tobytes()) for slant in self.slants)
        return self.number, self.in_odom, self.map_from_robot, self.readings.tobytes(), slants


def _array(readings: Sequence[RangeReading]) -> NDArray[np.void]:
    rows = [
        (
            reading.time_ns,
            reading.bearing_rad,
            reading.range_m or 0.0,
            reading.origin_x_m,
            reading.origin_y_m,
            reading.strength or 0,
            _CODES[reading.status],
            reading.strength is not None,
        )
        for reading in readings
    ]
    return np.array(rows, READING)


def _readings(rows: NDArray[np.void]) -> tuple[RangeReading, ...]:
    return tuple(map(_reading, rows.tolist()))


def _reading(row: Sequence[Any]) -> RangeReading:
    time_ns, bearing_rad, range_m, origin_x_m, origin_y_m, strength, code, has_strength = row
    return RangeReading(
        time_ns=time_ns,
        bearing_rad=bearing_rad,
        status=STATUSES[code],
        range_m=range_m if code in {_OK, _MISS} else None,
        strength=strength if has_strength else None,
        origin_x_m=origin_x_m,
        origin_y_m=origin_y_m,
    )
