"""Where something was over time, and between two times."""

from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass

from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2

_GAP_S = 1.0
"""Between two poses farther apart it is not known where a robot was that moved."""
_BEYOND_S = 0.1
"""A scan may come this long before the first pose or after the last one."""
_STANDS_M = 0.005
_STANDS_RAD = 0.005


@dataclass(frozen=True, slots=True)
class PoseTrack:
    """Poses in the order of their times."""

    times_s: tuple[float, ...]
    poses: tuple[Pose2, ...]

    @classmethod
    def of(cls, timed: Iterable[tuple[float, Pose2]]) -> "PoseTrack":
        """Return the track of poses in any order; of two at one time the later one counts."""
        ordered = sorted(dict(timed).items())
        return cls(tuple(time_s for time_s, _ in ordered), tuple(pose for _, pose in ordered))

    def at(self, time_s: float) -> Pose2 | None:
        """Return where it was, evenly between the pose before and the one after; None where that is not known.

        >>> PoseTrack.of([(1.0, Pose2(0.0, 0.0, 0.5)), (2.0, Pose2(4.0, 0.0, 1.5))]).at(1.75)
        Pose2(x_m=3.0, y_m=0.0, heading_rad=1.25)
        """
        after = bisect_left(self.times_s, time_s)
        if after < len(self.times_s) and self.times_s[after] == time_s:
            return self.poses[after]
        if after in {0, len(self.times_s)}:
            return self._beyond(time_s, after)
        begun_s, ended_s = self.times_s[after - 1 : after + 1]
        begun, ended = self.poses[after - 1 : after + 1]
        turned_rad = wrap_rad(ended.heading_rad - begun.heading_rad)
        stands = begun.distance_m(ended) <= _STANDS_M and abs(turned_rad) <= _STANDS_RAD
        # A robot that stood may be silent for as long as it likes.
        if ended_s - begun_s > _GAP_S and not stands:
            return None
        share = (time_s - begun_s) / (ended_s - begun_s)
        return Pose2(
            begun.x_m + share * (ended.x_m - begun.x_m),
            begun.y_m + share * (ended.y_m - begun.y_m),
            wrap_rad(begun.heading_rad + share * turned_rad),
        )

    def _beyond(self, time_s: float, after: int) -> Pose2 | None:
        if not self.times_s:
            return None
        nearest = 0 if after == 0 else -1
        return self.poses[nearest] if abs(self.times_s[nearest] - time_s) <= _BEYOND_S else None
