"""Readings as an array, for everything that computes on many at once."""

import struct
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus


def numbers_of(readings: Sequence[RangeReading]) -> NDArray[np.float64]:
    """Return measured readings as ``float64[n, 5]``.

    Per reading: bearing [rad], range [m], x and y of the beam's start [m], all in the robot frame; and 1 for a miss, 0
    for a hit.

    Raises:
        ValueError: a reading measured nothing.
    """
    miss, pack = ReadingStatus.MISS, _FIVE.pack
    try:
        packed = [  # a third faster than numpy.fromiter
            pack(r.bearing_rad, r.range_m, r.origin_x_m, r.origin_y_m, 1.0 if r.status is miss else 0.0)
            for r in readings
        ]
    except struct.error as error:
        unmeasured = next(reading.status for reading in readings if reading.range_m is None)
        raise ValueError(f"a {unmeasured} reading has no range") from error
    return np.frombuffer(bytearray().join(packed), np.float64).reshape(-1, 5)


_FIVE = struct.Struct("5d")
