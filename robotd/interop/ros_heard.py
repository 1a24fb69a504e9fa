"""What the messages of a bag say, as far as it is read: scans, odometry and frames."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.interop.ros_frames import Frames, flat_pose, frame_name, stamp_s

SCAN = "sensor_msgs/msg/LaserScan"
ODOMETRY = "nav_msgs/msg/Odometry"
FRAMES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
_FINEST_RAD = 1e-5
_ROUND_RAD = math.tau + 0.01


@dataclass(frozen=True, slots=True, eq=False)
class HeardLaser:
    """A scan as its message says it, its beams counter-clockwise."""

    frame: str
    time_s: float
    first_rad: float
    step_rad: float
    nearest_m: float
    farthest_m: float
    ranges_m: NDArray[np.float64]

    @classmethod
    def of(cls, message: Any, logged_s: float) -> "HeardLaser | None":
        """Return the scan of a message; None if it is damaged."""
        ranges_m = np.asarray(message.ranges, dtype=np.float64)
        first_rad, step_rad = float(message.angle_min), float(message.angle_increment)
        if len(ranges_m) < 2 or not math.isfinite(first_rad) or abs(first_rad) > _ROUND_RAD:
            return None
        if not _FINEST_RAD <= abs(step_rad) <= _ROUND_RAD / (len(ranges_m) - 1):
            return None
        # Clockwise: the same scan, told from its other end.
        if step_rad < 0.0:
            first_rad, step_rad, ranges_m = first_rad + step_rad * (len(ranges_m) - 1), -step_rad, ranges_m[::-1]
        stamped_s, farthest_m = stamp_s(message.header.stamp), float(message.range_max)
        return cls(
            frame=frame_name(message.header.frame_id),
            time_s=stamped_s or logged_s,  # a driver that knows no time says 0
            first_rad=first_rad,
            step_rad=step_rad,
            nearest_m=max(float(message.range_min), 0.0),
            farthest_m=farthest_m if farthest_m > 0.0 else math.inf,
            ranges_m=ranges_m,
        )


@dataclass(slots=True)
class HeardBag:
    """What of a bag is read."""

    lasers: list[HeardLaser] = field(default_factory=list)
    damaged: int = 0
    odometry: list[tuple[float, Pose2]] = field(default_factory=list)
    robot: str | None = None
    """Frame whose poses odometry tells, if it says."""
    frames: Frames = field(default_factory=Frames)

    def take(self, kind: str, message: Any, logged_s: float) -> None:
        """Take one message of the bag, in the order of their times."""
        if kind == SCAN:
            laser = HeardLaser.of(message, logged_s)
            self.damaged += laser is None
            self.lasers += [laser] if laser is not None else []
        elif kind == ODOMETRY:
            pose = message.pose.pose
            time_s = stamp_s(message.header.stamp) or logged_s
            self.odometry.append((time_s, flat_pose(pose.position, pose.orientation)))
            self.robot = frame_name(message.child_frame_id) or None
        else:
            self.frames.take(message.transforms)
