"""Are the poses of a log those of a mapping program, or raw odometry in their place?

Nothing in such a log says so. Three things show it: GMapping puts a copy of the pose behind each scan; where the robot
comes by again after a long way, scans at corrected poses fit each other, while at raw ones walls stand where the other
scan saw through; and raw poses lie on the ODOM lines around them.
"""

import enum
import math
from collections.abc import Iterator, Sequence

import numpy as np

from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2
from robotd.logs.odometry import pose_between
from robotd.logs.records import Odom
from robotd.logs.scan import Scan

_ON_TRACK_M = 0.02
_ON_TRACK_RAD = 0.02
_ON_TRACK_SHARE = 0.9
_MOUNT_MAX_M = 1.0
_SCANS_MAX = 800
"""Scans that are compared; of longer logs as many, evenly."""
_NEAR_M = 1.5
_TURNED_RAD = math.radians(40.0)
_TRAVEL_MIN_M = 15.0
"""A robot that comes by again after less has not drifted enough to tell."""
_SAME_M = 0.3
_REACH_M = 12.0
_POINTS_MIN = 20
_PAIRS_MIN = 12
_PAIRS_MAX = 400
_GOOD_SHARE = 0.9
_BAD_SHARE = 0.5


def lie_on_odometry(
    poses: Sequence[Pose2], places: Sequence[int], times_s: Sequence[float | None], lines: Sequence[Odom]
) -> bool:
    """Whether the robot poses of the scans are those that the ODOM lines around them tell.

    Args:
        poses: of the robot, a pose for each scan.
        places: how many ODOM lines stand before each scan.
        times_s: when the scans were taken.
        lines: the ODOM lines.
    """
    if len(lines) < 2 or not poses:
        return False
    on_track = sum(
        _is_near(pose, lines, place, time_s) for pose, place, time_s in zip(poses, places, times_s, strict=True)
    )
    return on_track >= _ON_TRACK_SHARE * len(poses)


def moved_to_odometry(
    lasers: Sequence[Pose2], places: Sequence[int], times_s: Sequence[float | None], lines: Sequence[Odom]
) -> Sequence[Pose2]:
    """Return where the robot was if its scanner sits where it did at the middle scan, seen from the odometry there.

    A PARAM may tell another mount than the one that made the log; odometry is what moves with the scanner all the
    same. The arguments are as for :func:`lie_on_odometry`; nothing is returned where no scanner sits so far away.
    """
    # In the middle: at the first scan odometry may be 0, whatever frame it is told in.
    middle = len(lasers) // 2
    odometry = pose_between(lines, places[middle], times_s[middle])
    if odometry is None or odometry.distance_m(lasers[middle]) > _MOUNT_MAX_M:
        return ()
    laser_from_robot = (odometry.inverse() @ lasers[middle]).inverse()
    return [laser @ laser_from_robot for laser in lasers]


def _is_near(pose: Pose2, lines: Sequence[Odom], place: int, time_s: float | None) -> bool:
    around = [lines[at].pose for at in (place - 1, place) if 0 <= at < len(lines)]
    between = pose_between(lines, place, time_s)
    return any(
        pose.distance_m(other) <= _ON_TRACK_M and abs(wrap_rad(pose.heading_rad - other.heading_rad)) <= _ON_TRACK_RAD
        for other in (*around, between)
        if other is not None
    )


class Fit(enum.Enum):
    """Whether scans of the same place, taken before and after a long way, fit at the poses that they have."""

    UNKNOWN = enum.auto()
    """The robot hardly came by again, or it is neither the one nor the other."""
    GOOD = enum.auto()
    """As no odometry is after such a way."""
    BAD = enum.auto()


def fit_of(scans: Sequence[Scan]) -> Fit:
    """Return how the scans of a log fit each other."""
    shares = fitting_shares(scans)
    if len(shares) < _PAIRS_MIN:
        return Fit.UNKNOWN
    # The median: a door that was opened meanwhile spoils a few pairs, drift spoils most.
    share = float(np.median(shares))
    return Fit.GOOD if share >= _GOOD_SHARE else Fit.BAD if share < _BAD_SHARE else Fit.UNKNOWN


def fitting_shares(scans: Sequence[Scan]) -> list[float]:
    """Return for each pair of scans that see the same place which share of the points of one the other sees, too."""
    some = scans[:: max(1, math.ceil(len(scans) / _SCANS_MAX))]
    shares = (_fitting_share(some[first], some[second]) for first, second in _revisits(some))
    return [share for share in shares if share is not None]


def _revisits(scans: Sequence[Scan]) -> Iterator[tuple[int, int]]:
    """Yield pairs of scans near each other with a long way between them, evenly over all that there are."""
    poses = np.array([(p.x_m, p.y_m, p.heading_rad) for p in (scan.laser_pose for scan in scans)]).reshape(-1, 3)
    steps_m = np.hypot(*np.diff(poses[:, :2], axis=0, prepend=poses[:1, :2]).T)
    way_m = np.cumsum(steps_m)
    found: list[tuple[int, int]] = []
    for index in range(len(scans)):
        beside = poses[: index + 1] - poses[index]
        near = np.hypot(beside[:, 0], beside[:, 1]) <= _NEAR_M
        alike = np.abs(np.mod(beside[:, 2] + math.pi, math.tau) - math.pi) <= _TURNED_RAD
        # By the way and not by the time: a robot that stood for an hour has not drifted.
        far_back = way_m[index] - way_m[: index + 1] >= _TRAVEL_MIN_M
        found.extend((int(earlier), index) for earlier in np.flatnonzero(near & alike & far_back))
    # Evenly over all of them: the first four hundred would be of the first room.
    yield from found[:: max(1, math.ceil(len(found) / _PAIRS_MAX))]


def _fitting_share(one: Scan, other: Scan) -> float | None:
    """Return the share of the other's points where one sees a wall, of those that one could see at all."""
    in_one = one.laser_pose.inverse() @ other.laser_pose
    met = other.hit & (other.ranges_m <= _REACH_M)
    directions_rad = other.angles_rad[met] + in_one.heading_rad
    x_m = in_one.x_m + other.ranges_m[met] * np.cos(directions_rad)
    y_m = in_one.y_m + other.ranges_m[met] * np.sin(directions_rad)
    beams = np.rint((np.arctan2(y_m, x_m) - one.angles_rad[0]) / one.step_rad).astype(np.intp)
    seen = (beams >= 0) & (beams < len(one.angles_rad))
    beams, distances_m = beams[seen], np.hypot(x_m, y_m)[seen]
    beyond_m = np.where(one.hit[beams], one.ranges_m[beams], np.nan) - distances_m
    told = np.isfinite(beyond_m) & (beyond_m >= -_SAME_M)  # what lies behind what one sees may be hidden
    return None if told.sum() < _POINTS_MIN else float((np.abs(beyond_m[told]) <= _SAME_M).mean())
