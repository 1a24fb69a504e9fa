"""Trajectories in the TUM form, which evo and other tools read: ``time x y z qx qy qz qw``, a pose a line."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from robotd.core.errors import RecordingError
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


def decode_tum(lines: Iterable[str]) -> Iterator[TimedPose]:
    """Yield the poses of a file, seen from above; comments and blank lines are passed over.

    Raises:
        RecordingError: a line is damaged; says which, and what was expected.
    """
    for number, line in enumerate(lines, 1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        try:
            time_s, x_m, y_m, _, *quaternion = map(float, words)
            qx, qy, qz, qw = quaternion
        except ValueError:
            raise RecordingError(f"line {number}: expected time x y z qx qy qz qw, got {line.strip()[:80]!r}") from None
        if not all(map(math.isfinite, (time_s, x_m, y_m, *quaternion))) or math.hypot(*quaternion) < 1e-9:
            raise RecordingError(f"line {number}: a number is not finite, or the quaternion is nothing")
        heading_rad = math.atan2(2 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz)
        yield TimedPose(time_s, Pose2(x_m, y_m, heading_rad))
