"""Counts per metre and per radian: straight out and back, turns there and back, seen against the first sweep."""

import math
from collections.abc import Generator

import numpy as np

from robotd.calibration.found import Calibration, Constants, Found, Procedure, Residuals, Seen, Step
from robotd.calibration.scale import Scale, fit_scale
from robotd.calibration.two_way_stops import SeenMove, TwoWayStop, along, round_about, stop, way
from robotd.contract.missions import DriveStraight, Turn
from robotd.core.pose import Pose2

_TRANSLATION, _ROTATION = 0, 1
_QUARTER_RAD = math.pi / 2.0
FULL_ROUNDS = 5
"""Turned each way to find a heading scale: the error of two sweeps is spread over all of them."""


def calibrate_odometry(now: Constants, distance_m: float) -> Procedure:
    """Find both scales, to some thousandths: ``distance_m`` ahead and back, twice, then a quarter turn each way."""
    here = yield from stop("look round before the first leg")
    straights: list[tuple[int, float, float]] = []
    for leg_m in (distance_m, -distance_m) * 2:
        led, here = yield from _leg(here, leg_m)
        there_m = math.copysign(math.hypot(led.pose.x_m, led.pose.y_m), leg_m)
        straights.append((led.counts[_TRANSLATION], there_m, led.way.place_error_m))
    turns: list[tuple[int, float, float]] = []
    for angle_rad in (_QUARTER_RAD, -_QUARTER_RAD):
        led, here = yield from _turn(here, angle_rad, round_about(angle_rad, angle_rad / 2.0))
        turns.append((led.counts[_ROTATION], led.pose.heading_rad, led.way.heading_error_rad))
    metre, radian = _scale(straights), _scale(turns)
    return Calibration(
        (_per_m(metre, now), _per_rad(radian, now)),
        (Residuals("straight legs", "m", metre.residuals), Residuals("turns", "rad", radian.residuals)),
    )


def calibrate_heading(now: Constants) -> Procedure:
    """Find the scale of the rotation to some hundredths of a percent: a quarter turn first, then whole rounds."""
    here = yield from stop("look round before the first turn")
    led, here = yield from _turn(here, _QUARTER_RAD, round_about(_QUARTER_RAD, _QUARTER_RAD / 2.0))
    coarse = led.counts[_ROTATION] / led.pose.heading_rad
    turns: list[tuple[int, float, float]] = []
    for rounds in (FULL_ROUNDS, -FULL_ROUNDS):
        led, here = yield from _turn(here, rounds * math.tau, round_about(0.0, math.pi))
        # The sweeps tell the turn but for whole rounds, which the first scale tells: it is good to a hundredth.
        by_counts_rad = led.counts[_ROTATION] / coarse
        off_rad = math.remainder(led.pose.heading_rad - by_counts_rad, math.tau)
        turns.append((led.counts[_ROTATION], by_counts_rad + off_rad, led.way.heading_error_rad))
    radian = _scale(turns)
    return Calibration((_per_rad(radian, now),), (Residuals("turns", "rad", radian.residuals),))


class _Led:
    """A leg: what was counted, and where it led."""

    def __init__(self, before: TwoWayStop, after: TwoWayStop, led: SeenMove) -> None:
        self.counts = (after.counts[0] - before.counts[0], after.counts[1] - before.counts[1])
        self.way = led
        self.pose = led.pose


def _leg(here: TwoWayStop, leg_m: float) -> Generator[Step, Seen, tuple[_Led, TwoWayStop]]:
    yield Step(DriveStraight(leg_m), f"drive {abs(leg_m):g} m {'ahead' if leg_m > 0.0 else 'back'}")
    there = yield from stop("look round")
    return _Led(here, there, way(here, there, along(leg_m))), there


def _turn(here: TwoWayStop, angle_rad: float, starts: list[Pose2]) -> Generator[Step, Seen, tuple[_Led, TwoWayStop]]:
    sense = "to the left" if angle_rad > 0.0 else "to the right"
    yield Step(Turn(angle_rad), f"turn {abs(math.degrees(angle_rad)):.0f} degrees {sense}")
    there = yield from stop("look round")
    return _Led(here, there, way(here, there, starts)), there


def _scale(legs: list[tuple[int, float, float]]) -> Scale:
    counts, ways, errors = np.array(legs, np.float64).T
    return fit_scale(counts, ways, errors)


def _per_m(scale: Scale, now: Constants) -> Found:
    return Found("drive", "counts_per_m", "1/m", scale.per_unit, scale.error, now.counts_per_m)


def _per_rad(scale: Scale, now: Constants) -> Found:
    return Found("drive", "counts_per_rad", "1/rad", scale.per_unit, scale.error, now.counts_per_rad)
