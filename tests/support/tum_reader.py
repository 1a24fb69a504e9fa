"""Trajectories in the TUM form, read back: as other tools read what is exported."""

import math
from collections.abc import Iterable, Iterator

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.interop.tum import TimedPose


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
