"""What must be added to every range: a wall at two distances, one by a tape, the other by what the sweeps tell."""

import math

import numpy as np

from robotd.calibration.found import Calibration, Constants, Found, Procedure, Residuals, Step
from robotd.calibration.two_way_stops import TwoWayStop, along, stop, way
from robotd.calibration.wall_bias import WallSeen, fit_wall, fit_wall_bias
from robotd.contract.missions import DriveStraight
from robotd.core.reading import ReadingStatus, Sweep

_TAPE_ERROR_M = 0.002
_NEAREST_M = 0.5
"""No nearer to the wall than this: the robot has a body, and no eye for it."""
_LEAST_LEG_M = 0.3


def calibrate_range(now: Constants, wall_m: float) -> Procedure:
    """Find the bias before a wall that is ``wall_m`` from the pan axis, then from another place."""
    first = yield from stop(f"look at the wall, {wall_m:.3f} m away")
    leg_m = leg_for(wall_m)
    yield Step(DriveStraight(leg_m), f"drive {abs(leg_m):.2f} m {'nearer' if leg_m > 0.0 else 'away'}")
    second = yield from stop("look at the wall from there")
    near = _walls(first, wall_m, _TAPE_ERROR_M)
    led = way(first, second, along(leg_m))
    normal_rad = float(np.mean([fit_wall(wall).normal_rad for wall in near]))
    nearer_m = led.pose.x_m * math.cos(normal_rad) + led.pose.y_m * math.sin(normal_rad)
    far = _walls(second, wall_m - nearer_m, math.hypot(_TAPE_ERROR_M, led.place_error_m))
    fit = fit_wall_bias((*near, *far))
    return Calibration(
        (Found("rangefinder", "range_bias_m", "m", now.range_bias_m + fit.bias_m, fit.error_m, now.range_bias_m),),
        tuple(
            Residuals(f"wall {wall.distance_m:.2f} m away", "m", residuals)
            for wall, residuals in zip((*near, *far), fit.residuals_m, strict=True)
        ),
    )


def leg_for(wall_m: float) -> float:
    """Return how far to drive for the second distance: nearer where there is room for it, else away."""
    nearer_m = min(wall_m / 2.0, wall_m - _NEAREST_M)
    return nearer_m if nearer_m >= _LEAST_LEG_M else -_NEAREST_M


def _walls(here: TwoWayStop, away_m: float, error_m: float) -> list[WallSeen]:
    return [_seen(sweep, away_m, error_m) for sweep in here.sweeps]


def _seen(sweep: Sweep, away_m: float, error_m: float) -> WallSeen:
    hits = [reading for reading in sweep.readings if reading.status is ReadingStatus.OK]
    return WallSeen(
        away_m,
        error_m,
        np.array([reading.bearing_rad for reading in hits]),
        np.array([reading.range_m for reading in hits], np.float64),
    )
