"""What the robot knows beyond one tie: the places that it may be in, carried from look to look as it moves.

A look that leaves several places is told with those alone that the robot can have come to. If that is one, and belief
leaves no doubt between it and nowhere, the robot is localized *by history*. If it is none, the robot was carried or its
wheels slipped: what was found is told as ambiguous, and sure as soon as the next look agrees with it
(:mod:`robotd.localization.history` has the reasons).
"""

import math
from dataclasses import dataclass, replace

from robotd.contract.estimate import Extent, PoseEstimate, PoseState
from robotd.core.motion_error import MotionError, Travel
from robotd.core.pose import IDENTITY, Pose2
from robotd.localization.history import History, Looked
from robotd.mission.whereabouts.tie import Tie
from robotd.mission.whereabouts.travelled import Travelled

_TIED_RAD = 0.35
"""20 degrees: how far off a heading may be that somebody told."""
_UNIQUE_M = 1.0
"""A region that reaches farther is no one place, even if it is the only one."""
_HELD_M = 0.1
"""Standard deviation of a place that walls hold; along a corridor it is metres."""


@dataclass(frozen=True, slots=True)
class Sure:
    """When one place that is left is taken for the place."""

    doubt_max: float
    """Places beside it, and *nowhere*, may have this share of the belief together."""
    is_proof: bool
    """Whether regions are proven: then belief has no say."""


class Carried:
    """The places that the robot may be in, and how far its wheels have come since it looked."""

    def __init__(self, motion: MotionError, sure: Sure) -> None:
        """Know nothing yet; ``motion`` says by how much the wheels may err."""
        self._motion = motion
        self._sure = sure
        self._history = History()
        self._travelled = Travelled()
        self._to_here = Travel()
        """To the look that is under way, or was last."""

    def forget(self) -> None:
        """Begin again: something else than a look has placed the robot, or it is on another map."""
        self._history, self._travelled, self._to_here = History(), Travelled(), Travel()

    def tied(self) -> None:
        """Take note that odometry was tied where a look found the robot: that is carried already."""

    def doubted(self) -> None:
        """Begin again: nobody saw what the wheels did."""
        self.forget()

    def moved(self, in_odom: Pose2) -> None:
        """Take what odometry tells next."""
        self._travelled.moved(in_odom)

    def looks(self, in_odom: Pose2) -> None:
        """Take note that a look round begins: what the base turns for it counts to the way from here on."""
        self._to_here = self._to_here.then(self._travelled.stopped(in_odom))

    def weighed(self, estimate: PoseEstimate, believed: Tie | None, in_odom: Pose2, near_m: float) -> PoseEstimate:
        """Return an estimate as it may be told; only from a final one anything is learned.

        Args:
            estimate: of the look round that began at ``in_odom``.
            believed: how odometry lies on the map, if that is believed.
            in_odom: where odometry put the robot.
            near_m: how far apart two poses are that are still one place.
        """
        history, travel = self._history, self._to_here
        # A robot that was tied by hand or by a map's stop has no look to carry on from: it has that tie.
        if history.is_anywhere and believed is not None:
            # Where odometry has come to already; what it may be off by since the tie is in the sums.
            history = History.at(believed.in_map(in_odom), near_m, _TIED_RAD)
            travel = replace(travel, step=IDENTITY)
        # Only where all places are told can the absence of one speak against it.
        is_complete = estimate.complete and estimate.regions_left_out == 0
        looked = history.looked(estimate.regions, travel, self._motion, is_complete=is_complete)
        told = self._told(estimate, history.moved(travel, self._motion), looked)
        # Of the same readings the next estimate is made: to learn from each would count them several times.
        if not estimate.final:
            return told
        self._history, self._to_here = looked.history, Travel()
        if told.state is PoseState.LOCALIZED:
            # Sure: what was kept beside it is no rival any more.
            self._history = History().looked(told.regions, Travel(), self._motion).history
        return told

    def _told(self, estimate: PoseEstimate, expected: History, looked: Looked) -> PoseEstimate:
        if looked.contradiction is not None:
            jumped_m = _centre(expected.members[0].extent).distance_m(estimate.regions[0].pose)
            return replace(
                estimate,
                state=PoseState.AMBIGUOUS,
                best=None,
                jumped_m=jumped_m,
                contradiction=looked.contradiction,
            )
        if estimate.state is not PoseState.AMBIGUOUS or all(looked.reachable):
            return estimate
        regions = tuple(one for one, is_left in zip(estimate.regions, looked.reachable, strict=True) if is_left)
        left = replace(estimate, regions=regions, unreachable=len(estimate.regions) - len(regions))
        if looked.only is None or not self._is_sure(left, looked.history.members[0].extent):
            return left
        return replace(left, state=PoseState.LOCALIZED, best=regions[0].pose, by_history=True)

    def _is_sure(self, left: PoseEstimate, extent: Extent) -> bool:
        """Whether the one region that is left is one place, and nothing but what cannot be spoke against it."""
        region = left.regions[0]
        reach_m = math.hypot(extent.x_max_m - extent.x_min_m, extent.y_max_m - extent.y_min_m)
        # A corridor is one region as well, and no place.
        if reach_m > _UNIQUE_M or not extent.holds(region.pose):
            return False
        # The belief beside a place is told of the best one alone, and this may be another: do the walls hold it there?
        if max(region.covariance[0][0], region.covariance[1][1]) > _HELD_M**2:
            return False
        doubt = left.belief_aside + left.belief_nowhere
        return self._sure.is_proof or doubt <= self._sure.doubt_max * (region.belief + doubt)


def _centre(extent: Extent) -> Pose2:
    heading_rad = (extent.heading_min_rad + extent.heading_max_rad) / 2.0
    return Pose2((extent.x_min_m + extent.x_max_m) / 2.0, (extent.y_min_m + extent.y_max_m) / 2.0, heading_rad)
