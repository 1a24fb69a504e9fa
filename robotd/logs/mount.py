"""Where a scanner sits on its robot."""

import math
from collections.abc import Mapping, Sequence

from robotd.core.angles import wrap_rad
from robotd.core.pose import IDENTITY, Pose2
from robotd.logs.bearings import names
from robotd.logs.records import LaserRecord

_SAME_M = 0.005
_SAME_RAD = 0.005
_LARGEST_M = 3.0


def mount_of(scans: Sequence[LaserRecord], params: Mapping[str, str], scanner: str) -> Pose2:
    """Return ``robot_from_laser``: what PARAM says, else how laser and odometry lie to each other if always the same.

    A rear scanner looks back: its heading is that of the records if they tell it from the robot's.
    """
    told = _told(scans)
    named = [_param(params, f"robot_{scanner}laser_{what}") for what in ("offset", "side_offset", "angular_offset")]
    if all(value is None for value in named):
        return told or IDENTITY
    x_m, y_m, heading_rad = (value or 0.0 for value in named)
    if named[2] is None and scanner == "rear" and told is not None:
        heading_rad = told.heading_rad
    return Pose2(x_m, y_m, wrap_rad(heading_rad))


def _param(params: Mapping[str, str], name: str) -> float | None:
    return float(params[name]) if name in params else None


def _told(scans: Sequence[LaserRecord]) -> Pose2 | None:
    """Return how laser and odometry lie to each other; None where that changes, as in corrected logs, or is unknown."""
    offsets = [
        scan.robot_pose.inverse() @ scan.laser_pose
        for scan in scans
        if scan.robot_pose is not None and scan.laser_pose is not None
    ]
    if not offsets or math.hypot(offsets[0].x_m, offsets[0].y_m) > _LARGEST_M:
        return None
    return offsets[0] if all(_same(offset, offsets[0]) for offset in offsets) else None


def _same(one: Pose2, other: Pose2) -> bool:
    return one.distance_m(other) <= _SAME_M and abs(wrap_rad(one.heading_rad - other.heading_rad)) <= _SAME_RAD


def is_upside_down(params: Mapping[str, str], scanner: str) -> bool:
    """Say whether a PARAM says that the scanner hangs upside down.

    CARMEN's driver turns the ranges of such a scanner round before it publishes them. So they are those of any
    other, and to turn them once more would mirror the building.
    """
    said = {params.get(name, "0").lower() for name in names(scanner, "flipped")}
    return not said <= {"0", "off", "no", "false"}
