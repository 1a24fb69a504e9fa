"""How far odometry may be off after some way and some turning, and what it is off by every time.

What counts are sums of way and of turn: a robot that went out and came back has driven, though it is where it was. Real
bases break any bound now and then (one counts backward driving as forward), so what is stated here is a prior and no
wall.
"""

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from statistics import median

import numpy as np
from numpy.typing import NDArray

from robotd.core.angles import wrap_rad
from robotd.core.pose import IDENTITY, Pose2


@dataclass(frozen=True, slots=True)
class Travel:
    """What the wheels say of the way from one place to another."""

    step: Pose2 = IDENTITY
    """The end as seen from the start."""
    way_m: float = 0.0
    """Sum of all that was driven, forward and backward."""
    turn_rad: float = 0.0
    """Sum of all turning, to the left and to the right."""

    @classmethod
    def through(cls, in_odom: Iterable[Pose2]) -> "Travel":
        """Return the travel through poses that odometry told, one after the other."""
        poses = list(in_odom)
        way_m = sum(one.distance_m(other) for one, other in itertools.pairwise(poses))
        turns = (wrap_rad(other.heading_rad - one.heading_rad) for one, other in itertools.pairwise(poses))
        return cls(poses[0].inverse() @ poses[-1], way_m, sum(map(abs, turns)))

    def then(self, further: "Travel") -> "Travel":
        """Return both, one after the other."""
        return Travel(self.step @ further.step, self.way_m + further.way_m, self.turn_rad + further.turn_rad)


@dataclass(frozen=True, slots=True)
class MotionError:
    """Standard deviations of odometry, and how many of them no step exceeds by right.

    Generous on purpose: with bounds as makers state them, one robot in two was outside of them at each third stop.
    """

    standing_m: float = 0.02
    per_way: float = 0.06
    """Metres per metre."""
    standing_rad: float = math.radians(0.7)
    rad_per_m: float = math.radians(2.5)
    per_turn: float = 0.06
    """Radians per radian."""
    bounded_by: float = 3.0
    """A stated bound is this many standard deviations."""

    def deviations(self, travel: Travel) -> tuple[float, float]:
        """Return the standard deviations of the place [m], along either axis, and of the heading [rad]."""
        # Linear in the way and not in its root: wheels of the wrong size err by the same share of all of it.
        heading_rad = self.standing_rad + self.rad_per_m * travel.way_m + self.per_turn * travel.turn_rad
        return self.standing_m + self.per_way * travel.way_m, heading_rad

    def bounds(self, travel: Travel) -> tuple[float, float]:
        """Return how far off the place [m] and the heading [rad] may be by right."""
        place_m, heading_rad = self.deviations(travel)
        return self.bounded_by * place_m, self.bounded_by * heading_rad

    def covariance(self, travel: Travel) -> NDArray[np.float64]:
        """Return the covariance of the step, ``float64[3, 3]`` of x, y [m] and heading [rad], in the frame of its end.

        The place is as uncertain along as across, so the frame is of no account to it.
        """
        place_m, heading_rad = self.deviations(travel)
        return np.diag([place_m**2, place_m**2, heading_rad**2])


@dataclass(frozen=True, slots=True)
class MotionBias:
    """What odometry is off by every time, learned from where the robot then turned out to be.

    Medians, so that a step which was misjudged once teaches nothing.
    """

    latest: tuple[tuple[float, float, float, float, float], ...] = ()
    """Way [m], turn with its sign [rad], and by how much the step was off: x, y [m] and heading [rad]; oldest first."""
    _per_m: tuple[float, float, float] = field(default=(0.0, 0.0, 0.0))
    """Of x, y [m] and heading [rad]."""
    _per_rad: float = 0.0

    def learned(self, travel: Travel, step: Pose2) -> "MotionBias":
        """Return what is known after one more step that was truly ``step``."""
        off = travel.step.inverse() @ step
        one = (travel.way_m, travel.step.heading_rad, off.x_m, off.y_m, off.heading_rad)
        latest = (*self.latest, one)[-_REMEMBERED:]
        # Of shorter ways the error of the look itself is most of what was off.
        driven = [other for other in latest if other[0] >= _DRIVEN_M]
        per_m = tuple(median(row[of] / row[0] for row in driven) if driven else 0.0 for of in (2, 3, 4))
        # What driving alone turned it by is taken off first: else a base that pulls to one side would seem to
        # turn too far.
        turned = [(row[4] - per_m[2] * row[0]) / row[1] for row in latest if abs(row[1]) >= _TURNED_RAD]
        enough = len(turned) >= _ENOUGH
        return MotionBias(latest, (per_m[0], per_m[1], per_m[2]), median(turned) if enough else 0.0)

    def corrected(self, travel: Travel) -> Pose2:
        """Return the step as it will likely turn out to have been."""
        if len(self.latest) < _ENOUGH:
            return travel.step
        x_m, y_m, heading_rad = (rate * travel.way_m for rate in self._per_m)
        heading_rad += self._per_rad * travel.step.heading_rad
        return travel.step @ Pose2(x_m, y_m, wrap_rad(heading_rad))


_REMEMBERED = 50
_ENOUGH = 8
"""Steps that teach anything."""
_DRIVEN_M = 0.2
_TURNED_RAD = 0.3
