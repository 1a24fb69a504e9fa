"""Readings as columns, for everything that computes on many at once."""

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus


@dataclass(frozen=True, slots=True, eq=False)
class Readings:
    """The measured readings of one stop, hits and misses, in the order in which they were made; robot frame."""

    # Not objects: a search for garbage among half a million of them held the event loop for 0.3 s (decision 29).
    rows: NDArray[np.float64]
    """``float64[n, 5]``, contiguous, as the kernels take them: the columns that are named below, 1 for a miss."""

    @classmethod
    def of(cls, readings: Sequence[RangeReading]) -> "Readings":
        """Take measured readings.

        Raises:
            ValueError: a reading measured nothing.
        """
        miss, pack = ReadingStatus.MISS, _FIVE.pack
        try:
            # Packing refuses None by itself, so measured readings need no check of their own.
            packed = [  # a third faster than numpy.fromiter
                pack(r.bearing_rad, r.range_m, r.origin_x_m, r.origin_y_m, 1.0 if r.status is miss else 0.0)
                for r in readings
            ]
        except struct.error as error:
            unmeasured = next(reading.status for reading in readings if reading.range_m is None)
            raise ValueError(f"a {unmeasured} reading has no range") from error
        return cls(np.frombuffer(bytearray().join(packed), np.float64).reshape(-1, 5))

    @classmethod
    def none(cls) -> "Readings":
        """Return no readings."""
        return cls(np.empty((0, 5)))

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.rows)

    def __getitem__(self, which: slice | NDArray[np.intp] | NDArray[np.bool_]) -> "Readings":
        """Return some of them: a slice, by indices, or by a mask."""
        # The kernels read rows as plain memory, without strides.
        return Readings(np.ascontiguousarray(self.rows[which]))

    def joined(self, later: "Readings") -> "Readings":
        """Return these and later ones."""
        return Readings(np.concatenate((self.rows, later.rows)))

    def with_ranges(self, range_m: NDArray[np.float64]) -> "Readings":
        """Return the same readings with other ranges ``float64[n]``."""
        rows = self.rows.copy()
        rows[:, 1] = range_m
        return Readings(rows)

    @property
    def bearing_rad(self) -> NDArray[np.float64]:
        """Direction of each beam, ``float64[n]``."""
        column: NDArray[np.float64] = self.rows[:, 0]
        return column

    @property
    def range_m(self) -> NDArray[np.float64]:
        """How far each obstacle is from the beam's start; for a miss, how far none is: ``float64[n]``."""
        column: NDArray[np.float64] = self.rows[:, 1]
        return column

    @property
    def start_x_m(self) -> NDArray[np.float64]:
        """Where each beam starts, ``float64[n]``."""
        column: NDArray[np.float64] = self.rows[:, 2]
        return column

    @property
    def start_y_m(self) -> NDArray[np.float64]:
        """Where each beam starts, ``float64[n]``."""
        column: NDArray[np.float64] = self.rows[:, 3]
        return column

    @property
    def is_miss(self) -> NDArray[np.bool_]:
        """Which met nothing up to the cut-off, ``bool[n]``."""
        column: NDArray[np.bool_] = self.rows[:, 4] > 0.0
        return column

    @property
    def is_hit(self) -> NDArray[np.bool_]:
        """Which met an obstacle, ``bool[n]``."""
        return ~self.is_miss

    @property
    def heads_m(self) -> NDArray[np.float64]:
        """Where each beam ends, ``float64[n, 2]``: x, y."""
        x_m = self.start_x_m + self.range_m * np.cos(self.bearing_rad)
        y_m = self.start_y_m + self.range_m * np.sin(self.bearing_rad)
        return np.stack((x_m, y_m), axis=1)

    def heads_at(self, pose: Pose2) -> NDArray[np.float64]:
        """Return where each beam ends if the robot is at a pose, ``float64[n, 2]``: x, y in the frame of that."""
        cosine, sine = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
        heads_m: NDArray[np.float64] = self.heads_m @ np.array([[cosine, sine], [-sine, cosine]]) + (pose.x_m, pose.y_m)
        return heads_m


_FIVE = struct.Struct("5d")
