"""Where the robot believes it is: known here, and written nowhere else.

Theory of operation: one map is in use at a time, and one :class:`Tie` says how the odometry frame lies on it. The tie
comes with the map (:meth:`Whereabouts.adopt`) or is made where a look round finds the robot. It is doubted where a look
round finds it nowhere near (:meth:`Whereabouts.looked`), and where nobody saw what its wheels did
(:meth:`Whereabouts.doubt`); odometry carries it on in between (:meth:`Whereabouts.moved`). Another map begins with
nothing: what was believed on the last one says nothing of this one.

All of it happens on the loop, and nothing here reads a clock, waits, moves or stops anything: a replay that is told the
same comes to the same. What is known beyond one tie, as the places that a robot carries along while it is ambiguous,
is :class:`~robotd.mission.whereabouts.carried.Carried`; recordings of before held each look against the last sure one
alone (:class:`~robotd.mission.whereabouts.jumps.Jumps`).
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.angles import wrap_rad
from robotd.core.motion_error import Travel
from robotd.core.pose import Odometry, Pose2
from robotd.mission.whereabouts.jumps import Jumps
from robotd.mission.whereabouts.map_in_use import MapInUse
from robotd.mission.whereabouts.tie import Tie
from robotd.mission.whereabouts.travelled import Travelled

_MOVED_M = 0.02
_TURNED_RAD = 0.02
"""Nearer than both to what was said last, a prediction is no news."""


class Weighing(Protocol):
    """What is known of where the robot can be, by which looks round are weighed before they are told."""

    def forget(self) -> None:
        """Begin again: something else than a look has placed the robot, or it is on another map."""

    def tied(self) -> None:
        """Take note that odometry was tied where a look found the robot."""

    def doubted(self) -> None:
        """Take note that nobody saw what the wheels did."""

    def moved(self, in_odom: Pose2) -> None:
        """Take what odometry tells next."""

    def looks(self, in_odom: Pose2) -> None:
        """Take note that a look round begins."""

    def weighed(self, estimate: PoseEstimate, believed: Tie | None, in_odom: Pose2, near_m: float) -> PoseEstimate:
        """Return an estimate as it may be told; see :meth:`.Carried.weighed`."""


class Whereabouts:
    """The map in use, and where the robot is on it."""

    def __init__(self, weighing: Weighing | None = None) -> None:
        """Know nothing yet; without ``weighing`` each look is held against the last sure one alone."""
        self._map: MapInUse | None = None
        self._tie: Tie | None = None
        self._said: Pose2 | None = None
        """The pose that was said last; a prediction is news only if it lies far enough from there."""
        self._weighing = weighing or Jumps()
        self._travelled = Travelled()

    @property
    def map_in_use(self) -> MapInUse | None:
        """The map that poses are told on."""
        return self._map

    @property
    def tie(self) -> Tie | None:
        """How odometry lies on that map, believed or not; None while nothing ever tied them."""
        return self._tie

    @property
    def believed(self) -> Tie | None:
        """The tie, if it is believed: what is not must not move the robot."""
        return None if self._tie is None or self._tie.is_doubted else self._tie

    def adopt(self, another: MapInUse, tie: Tie | None = None) -> None:
        """Take another map into use, with what ties odometry to it, if anything does."""
        self._map, self._tie, self._said = another, tie, None
        self._weighing.forget()

    def pose_of(self, odometry: Odometry) -> Pose2 | None:
        """Return where odometry places the robot on the map, if anything ties them that is believed."""
        return self.in_map(odometry.in_odom)

    def in_map(self, in_odom: Pose2) -> Pose2 | None:
        """Return where a pose in the odometry frame lies on the map, if anything ties them that is believed."""
        believed = self.believed
        return None if believed is None else believed.in_map(in_odom)

    def tied(self, estimate: PoseEstimate, in_odom: Pose2 | None) -> PoseEstimate:
        """Return an estimate of a robot at ``in_odom`` with how odometry lies on the map: as it is told."""
        believed = self.believed
        return replace(estimate, in_odom=in_odom, map_from_odom=None if believed is None else believed.map_from_odom)

    def heading_of(self, odometry: Odometry) -> float | None:
        """Return the robot's heading in the map frame [rad], if anything ever tied odometry to the map.

        A doubted tie will do: a robot that does not know where it is may still know which way it looks.
        """
        return None if self._tie is None else self._tie.in_map(odometry.in_odom).heading_rad

    def weighed(self, estimate: PoseEstimate, in_odom: Pose2, *, near_m: float) -> PoseEstimate:
        """Return the estimate of a look round as it may be told: not sure of a place where the robot should not be.

        Where it cannot have come to any place that a look leaves, a second look that agrees is sure.
        """
        return self._weighing.weighed(estimate, self.believed, in_odom, near_m)

    def looks(self, in_odom: Pose2) -> None:
        """Take note that a look round begins, before the base turns for it."""
        self._weighing.looks(in_odom)

    def said(self, estimate: PoseEstimate) -> None:
        """Take note of an estimate that is told: what is predicted next is measured against it."""
        if estimate.final and estimate.state is PoseState.LOCALIZED:
            self._said = estimate.best

    def looked(self, estimate: PoseEstimate, in_odom: Pose2, *, near_m: float, near_rad: float) -> None:
        """Learn from a look round that began at ``in_odom``: tie odometry where the robot was found, or doubt the tie.

        A tie is doubted if no region comes within ``near_m`` and ``near_rad`` of where it puts the robot. Readings that
        allow no answer at all, as in a fog of failed ones, say nothing against it.
        """
        if estimate.state is PoseState.LOCALIZED and estimate.best is not None:
            self._tie = Tie.between(estimate.best, in_odom)
            self._weighing.tied()
            return
        says_something = estimate.regions or estimate.state is PoseState.LOST
        if self._tie is None or not says_something:
            return
        believed = self._tie.in_map(in_odom)
        if not any(region.extent.holds(believed, near_m=near_m, near_rad=near_rad) for region in estimate.regions):
            self._tie = self._tie.doubted()

    def stopped(self, in_odom: Pose2) -> Travel:
        """Return the travel since the last stop of a map in the making to this one, which began at ``in_odom``."""
        return self._travelled.stopped(in_odom)

    def placed(self, map_from_robot: Pose2, in_odom: Pose2, *, is_found: bool) -> None:
        """Tie odometry to where a stop was placed; a tie that is doubted stays so until the map has a word in it."""
        is_doubted = self._tie is not None and self._tie.is_doubted and not is_found
        tie = Tie.between(map_from_robot, in_odom)
        self._tie = tie.doubted() if is_doubted else tie
        self._said = None  # the tie is another, which is news however little it moves the robot
        self._weighing.forget()

    def bumped(self, in_odom: Pose2, bumpers_rad: Sequence[float], robot_radius_m: float) -> None:
        """Put what the robot bumped into on the map, if it is known where the robot was then."""
        pose = self.in_map(in_odom)
        if self._map is None or pose is None:
            return
        for bumper_rad in bumpers_rad:
            place_m = (robot_radius_m * math.cos(bumper_rad), robot_radius_m * math.sin(bumper_rad))
            self._map.bumped(pose.transform(*place_m))

    def doubt(self) -> bool:
        """Believe odometry no longer: nobody saw what the wheels did, or they told nonsense; return whether it was."""
        # Told even if nothing is tied: a robot that carries several places along loses those, too.
        self._weighing.doubted()
        believed = self.believed
        if believed is None:
            return False
        self._tie, self._said = believed.doubted(), None
        return True

    def moved(self, odometry: Odometry) -> PoseEstimate | None:
        """Return the estimate that odometry leads to, if the robot has moved since the last one said, else None."""
        self._weighing.moved(odometry.in_odom)
        self._travelled.moved(odometry.in_odom)
        return self.predicted(odometry)

    def predicted(self, odometry: Odometry) -> PoseEstimate | None:
        """Return where odometry places the robot, if that is news."""
        pose = self.pose_of(odometry)
        if self._map is None or pose is None or not self._has_moved(pose):
            return None
        self._said = pose
        predicted = PoseEstimate(odometry.time_ns, PoseState.PREDICTED, pose, (), 0, 0, True, self._map.map_id)
        return self.tied(predicted, odometry.in_odom)

    def _has_moved(self, pose: Pose2) -> bool:
        if self._said is None:
            return True
        turned_rad = abs(wrap_rad(pose.heading_rad - self._said.heading_rad))
        return pose.distance_m(self._said) > _MOVED_M or turned_rad > _TURNED_RAD


def unlocalized(time_ns: int, map_id: str) -> PoseEstimate:
    """Return the estimate of a robot that does not know where it is: said at once, never by silence."""
    return PoseEstimate(time_ns, PoseState.LOST, None, (), 0, 0, True, map_id)
