"""Trajectories in the TUM form, which evo and other tools read: ``time x y z qx qy qz qw``, a pose a line."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from robotd.core.pose import Pose2


@dataclass(frozen=True, slots=True)
class TimedPose:
    """Where something was, and when."""

    time_s: float
    """Unix time."""
    pose: Pose2


def encode_tum(poses: Iterable[TimedPose]) -> Iterator[str]:
    """Yield a line for each pose; numbers come back to the last bit but for the heading, to 1e-15."""
    for timed in poses:
        pose, half_rad = timed.pose, timed.pose.heading_rad / 2
        numbers = (pose.x_m, pose.y_m, 0.0, 0.0, 0.0, math.sin(half_rad), math.cos(half_rad))
        # Nine places: a float of a second since 1970 has no more, and a shortest form would hide which is which.
        yield f"{timed.time_s:.9f} {' '.join(map(repr, numbers))}\n"
