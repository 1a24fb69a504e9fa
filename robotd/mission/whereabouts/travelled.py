"""How far the wheels have come since the last stop: sums of way and turn, and where that led."""

from robotd.core.angles import wrap_rad
from robotd.core.motion_error import Travel
from robotd.core.pose import IDENTITY, Pose2


class Travelled:
    """Adds up what odometry tells, from stop to stop."""

    def __init__(self) -> None:
        self._last: Pose2 | None = None
        self._stop: Pose2 | None = None
        self._way_m = 0.0
        self._turn_rad = 0.0

    def moved(self, in_odom: Pose2) -> None:
        """Take what odometry tells next."""
        if self._last is not None:
            self._way_m += in_odom.distance_m(self._last)
            # Sums, not differences: wheels err on all of the way there and back, though the robot ends where it
            # began.
            self._turn_rad += abs(wrap_rad(in_odom.heading_rad - self._last.heading_rad))
        self._last = in_odom

    def stopped(self, in_odom: Pose2) -> Travel:
        """Return the travel since the last stop to this one, which is then the last; to the first it leads nowhere."""
        step = Travel(IDENTITY if self._stop is None else self._stop.inverse() @ in_odom, self._way_m, self._turn_rad)
        self._stop, self._way_m, self._turn_rad = in_odom, 0.0, 0.0
        return step
