"""From encoder counts to a pose: dead reckoning of a synchro-drive."""

import math

from robotd.core.angles import wrap_rad
from robotd.core.pose import IDENTITY, Pose2
from robotd.hardware.devices.calibration import DriveCalibration

_COUNTER_SPAN = 1 << 32


class Odometer:
    """Integrates counts: from one report to the next the base is taken to follow an arc.

    The pose goes on from where it was when a board restarts and its counts with it: how far the base moved
    unseen cannot be known, and a jump would be worse.
    """

    def __init__(self, calibration: DriveCalibration) -> None:
        self._calibration = calibration
        self._seen: tuple[int, int, int] | None = None
        self.in_odom: Pose2 = IDENTITY
        """Where the base is; the origin is where it was first seen."""

    def update(self, boot_id: int, translate_counts: int, rotate_counts: int) -> Pose2:
        """Return the pose after a report of cumulative signed 32-bit counts, which wrap."""
        seen, self._seen = self._seen, (boot_id, translate_counts, rotate_counts)
        if seen is None or seen[0] != boot_id:
            return self.in_odom
        way_m = _gained(seen[1], translate_counts) / self._calibration.counts_per_m
        turn_rad = _gained(seen[2], rotate_counts) / self._calibration.counts_per_rad
        half_rad = turn_rad / 2
        chord_m = way_m * math.sin(half_rad) / half_rad if half_rad else way_m
        self.in_odom = Pose2(
            self.in_odom.x_m + chord_m * math.cos(self.in_odom.heading_rad + half_rad),
            self.in_odom.y_m + chord_m * math.sin(self.in_odom.heading_rad + half_rad),
            wrap_rad(self.in_odom.heading_rad + turn_rad),
        )
        return self.in_odom


def _gained(before: int, after: int) -> int:
    """Return the shorter way from one count to another round the wrap.

    >>> _gained(2**31 - 1, -(2**31))
    1
    """
    return (after - before + _COUNTER_SPAN // 2) % _COUNTER_SPAN - _COUNTER_SPAN // 2
