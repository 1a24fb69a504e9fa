"""Poses in the plane, and the frames they tie together.

A transform reads ``map_from_robot``: it takes robot coordinates to map coordinates,
and ``map_from_odom @ odom_from_robot`` is ``map_from_robot``.
"""

import math
from dataclasses import dataclass

from robotd.core.angles import wrap_rad


@dataclass(frozen=True, slots=True)
class Pose2:
    """Position and heading of one frame in another (the paper's *pose*)."""

    x_m: float
    y_m: float
    heading_rad: float
    """Counter-clockwise from +x."""

    def __matmul__(self, inner: "Pose2") -> "Pose2":
        """Return ``self`` after ``inner``: ``a_from_b @ b_from_c`` is ``a_from_c``.

        >>> Pose2(1.0, 0.0, math.pi / 2) @ Pose2(1.0, 0.0, 0.0)
        Pose2(x_m=1.0, y_m=1.0, heading_rad=1.5707963267948966)
        """
        x_m, y_m = self.transform(inner.x_m, inner.y_m)
        return Pose2(x_m, y_m, wrap_rad(self.heading_rad + inner.heading_rad))

    def inverse(self) -> "Pose2":
        """Return ``b_from_a`` of ``a_from_b``."""
        cos, sin = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return Pose2(
            -(cos * self.x_m + sin * self.y_m),
            -(-sin * self.x_m + cos * self.y_m),
            wrap_rad(-self.heading_rad),
        )

    def transform(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return the outer coordinates of a point given in the inner frame."""
        cos, sin = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return self.x_m + cos * x_m - sin * y_m, self.y_m + sin * x_m + cos * y_m

    def distance_m(self, other: "Pose2") -> float:
        """Return the straight distance between the two origins [m]."""
        return math.hypot(other.x_m - self.x_m, other.y_m - self.y_m)


IDENTITY = Pose2(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Twist2:
    """Velocity of a synchro-drive: along its heading, and of its heading."""

    speed_mps: float
    turn_radps: float

    @property
    def is_zero(self) -> bool:
        """Whether the robot stands."""
        return self.speed_mps == 0.0 and self.turn_radps == 0.0


STANDSTILL = Twist2(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Odometry:
    """Wheel-derived pose: continuous, and drifting (the ``odom`` frame of REP-105)."""

    time_ns: int
    """When it was measured, monotonic clock of this host [ns]."""
    in_odom: Pose2
    twist: Twist2
    counts: tuple[int, int] | None = None
    """What its encoders counted of translation and of rotation since the base was first seen, as they count; None if
    that is not known."""
