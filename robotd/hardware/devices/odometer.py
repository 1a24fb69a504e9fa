"""From encoder counts to a pose: dead reckoning of a synchro-drive."""

import math

from robotd.core.angles import wrap_rad
from robotd.core.clock import NS_PER_S
from robotd.core.pose import IDENTITY, Pose2
from robotd.hardware.devices.calibration import DriveCalibration
from robotd.hardware.devices.credible import check_way

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
        self.counts = (0, 0)
        """What was counted of translation and rotation since then; it does not wrap."""

    def start_again(self) -> None:
        """Take the next counts, whatever they are, for those of where the base is."""
        self._seen = None

    def gained(self, boot_id: int, translate_counts: int, rotate_counts: int) -> tuple[float, float]:
        """Return the way [m] and the turn [rad] that a report of cumulative signed 32-bit counts, which wrap, adds."""
        translated, rotated = self._counted(boot_id, translate_counts, rotate_counts)
        return translated / self._calibration.counts_per_m, rotated / self._calibration.counts_per_rad

    def update(self, boot_id: int, translate_counts: int, rotate_counts: int) -> Pose2:
        """Return the pose after a report of cumulative signed 32-bit counts, which wrap."""
        way_m, turn_rad = self.gained(boot_id, translate_counts, rotate_counts)
        translated, rotated = self._counted(boot_id, translate_counts, rotate_counts)
        self.counts = (self.counts[0] + translated, self.counts[1] + rotated)
        self._seen = (boot_id, translate_counts, rotate_counts)
        half_rad = turn_rad / 2
        # An arc leaves its start at half the turn, along its chord; on a straight leg the two are one.
        chord_m = way_m * math.sin(half_rad) / half_rad if half_rad else way_m
        self.in_odom = Pose2(
            self.in_odom.x_m + chord_m * math.cos(self.in_odom.heading_rad + half_rad),
            self.in_odom.y_m + chord_m * math.sin(self.in_odom.heading_rad + half_rad),
            wrap_rad(self.in_odom.heading_rad + turn_rad),
        )
        return self.in_odom

    def _counted(self, boot_id: int, translate_counts: int, rotate_counts: int) -> tuple[int, int]:
        if self._seen is None or self._seen[0] != boot_id:
            return 0, 0
        return _gained(self._seen[1], translate_counts), _gained(self._seen[2], rotate_counts)


class JudgedOdometer:
    """An odometer that believes no way which the base cannot have made in the time."""

    def __init__(self, device: str, calibration: DriveCalibration) -> None:
        self._device = device
        self._odometer = Odometer(calibration)
        self._time_ns = 0

    @property
    def counts(self) -> tuple[int, int]:
        """What was counted of translation and rotation since the base was first seen."""
        return self._odometer.counts

    def start_again(self) -> None:
        """Believe the next counts: somebody has looked at the base since."""
        self._odometer.start_again()

    def update(self, boot_id: int, translate_counts: int, rotate_counts: int, time_ns: int) -> Pose2:
        """Return the pose after a report of counts and the time at which they were measured.

        Raises:
            DeviceError: no base gets there in that time; the report is left out.
        """
        way_m, turn_rad = self._odometer.gained(boot_id, translate_counts, rotate_counts)
        # Before anything is taken over: a report that cannot be leaves no trace.
        check_way(self._device, way_m, turn_rad, (time_ns - self._time_ns) / NS_PER_S)
        self._time_ns = time_ns
        return self._odometer.update(boot_id, translate_counts, rotate_counts)


def _gained(before: int, after: int) -> int:
    """Return the shorter way from one count to another round the wrap.

    >>> _gained(2**31 - 1, -(2**31))
    1
    """
    return (after - before + _COUNTER_SPAN // 2) % _COUNTER_SPAN - _COUNTER_SPAN // 2
