"""A fix far from where odometry puts the robot is not taken at its word; a second look that agrees with it is.

Two rooms alike but for a cabinet explain a sweep nearly as well, and the wrong one may be the better mapped. What tells
them apart is how the robot came to be there. Odometry errs by a small share of the way since it was last tied, so a fix
beyond that means that the robot was carried, or that the fix is wrong: both are rare, and one look cannot tell which.
"""

from dataclasses import replace

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2
from robotd.mission.whereabouts.tie import Tie

_ERROR_SHARE = 0.1
"""Of the way: wheels of a synchro-drive slip by a few per cent, on carpet by more."""
_ERROR_RAD = 0.35
"""20 degrees, whatever the way: a fix turned by more is another place."""


class Jumps:
    """What was found where the robot should not be, until a second look agrees."""

    def __init__(self) -> None:
        self._found: Tie | None = None
        self._way_m = 0.0
        self._last: Pose2 | None = None

    def forget(self) -> None:
        """Begin again: odometry is tied, or another map is in use."""
        self._found, self._way_m = None, 0.0

    def tied(self) -> None:
        """Take note that odometry was tied where a look found the robot."""
        self.forget()

    def doubted(self) -> None:
        """Take note that odometry is believed no longer; what was found, if anything was, is as true as before."""

    def looks(self, in_odom: Pose2) -> None:
        """Take note that a look round begins; the way is counted to where it ends."""

    def moved(self, in_odom: Pose2) -> None:
        """Measure the way since odometry was tied."""
        if self._last is not None:
            self._way_m += in_odom.distance_m(self._last)
        self._last = in_odom

    def weighed(self, estimate: PoseEstimate, believed: Tie | None, in_odom: Pose2, near_m: float) -> PoseEstimate:
        """Return a final estimate as it may be told: ambiguous if it jumped and no look before it says the same.

        Args:
            estimate: of a look round that began at ``in_odom``; one that is not localized is returned as it is.
            believed: how odometry lies on the map, if that is believed.
            in_odom: where odometry put the robot.
            near_m: how far apart two poses are that are still one place.
        """
        if estimate.best is None or not estimate.final:
            return estimate
        # After a jump the look that jumped is what the next must agree with, not the odometry that it contradicts.
        expected = self._found or believed
        if expected is None:
            return estimate
        there = expected.in_map(in_odom)
        off_m = there.distance_m(estimate.best)
        turned_rad = abs(wrap_rad(there.heading_rad - estimate.best.heading_rad))
        if off_m <= near_m + _ERROR_SHARE * self._way_m and turned_rad <= _ERROR_RAD:
            return estimate
        # Kept as a tie, so that the way driven until the next look is in it: they may be taken at two places.
        self._found = Tie.between(estimate.best, in_odom)
        self._way_m = 0.0  # the next look is held against this one
        return replace(estimate, state=PoseState.AMBIGUOUS, best=None, jumped_m=off_m)
