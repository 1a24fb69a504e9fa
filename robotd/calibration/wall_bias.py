"""A range bias, from a flat wall at known distances.

A beam at the angle a from the wall's normal meets it after D / cos a. Ways alone tell no bias, since it is the same
before and after each; and how a wall is bent by it tells little: 7 mm give or take, from four sweeps with errors of
20 mm. So one distance comes from a tape (decision 38); further ones come from the way driven since, as the sweeps tell
it, and show whether the bias is the same farther off.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import CalibrationError

_WIDEST_RAD = math.radians(35.0)
"""From the heading: beams that graze a wall measure it badly, whatever their instrument."""
_GATES_M = (0.3, 0.1, 0.06, 0.06, 0.06)
_FEWEST = 20
_LEAST_SHARE = 0.7
"""Of the beams ahead must agree on the wall."""


@dataclass(frozen=True, slots=True, eq=False)
class WallSeen:
    """What one sweep saw of the wall ahead."""

    distance_m: float
    """How far the wall is from where the beams start, square to it."""
    distance_error_m: float
    """Standard deviation of that."""
    bearings_rad: NDArray[np.float64]
    """``float64[n]``, from the heading."""
    ranges_m: NDArray[np.float64]
    """``float64[n]``, level."""


@dataclass(frozen=True, slots=True, eq=False)
class WallBias:
    """What must be added to every range."""

    bias_m: float
    error_m: float
    each_m: tuple[float, ...]
    """The same of each sweep by itself."""
    bearings_rad: tuple[NDArray[np.float64], ...]
    """Of the readings that were used, by sweep."""
    residuals_m: tuple[NDArray[np.float64], ...]
    """How much longer these are than wall and bias say."""


@dataclass(frozen=True, slots=True, eq=False)
class WallFit:
    """What one sweep says by itself."""

    bias_m: float
    error_m: float
    normal_rad: float
    """Direction in which the wall is nearest."""
    bearings_rad: NDArray[np.float64]
    off_m: NDArray[np.float64]
    """``float64[n]``: how much longer the readings used are than wall and bias say."""


def fit_wall_bias(walls: Sequence[WallSeen]) -> WallBias:
    """Return the bias with which the wall is where it is in all sweeps.

    Raises:
        CalibrationError: there is no flat wall ahead, or it is elsewhere.
    """
    fitted = [fit_wall(wall) for wall in walls]
    biases = np.array([one.bias_m for one in fitted])
    weights = np.array([one.error_m for one in fitted]) ** -2.0
    bias_m = float((weights * biases).sum() / weights.sum())
    free = max(1, len(fitted) - 1)
    disagreement = float((weights * (biases - bias_m) ** 2).sum()) / free
    return WallBias(
        bias_m=bias_m,
        error_m=math.sqrt(max(1.0, disagreement) / float(weights.sum())),
        each_m=tuple(biases.tolist()),
        bearings_rad=tuple(one.bearings_rad for one in fitted),
        residuals_m=tuple(one.off_m + one.bias_m - bias_m for one in fitted),
    )


def fit_wall(wall: WallSeen) -> WallFit:
    """Return bias and direction of the wall by one sweep, by Gauss-Newton steps within a gate that narrows.

    Raises:
        CalibrationError: there is no flat wall ahead, or it is elsewhere.
    """
    ahead = np.abs(wall.bearings_rad) <= _WIDEST_RAD
    bearings_rad, ranges_m = wall.bearings_rad[ahead], wall.ranges_m[ahead]
    if len(ranges_m) < _FEWEST:
        raise CalibrationError("nothing is ahead: face a flat wall, 1 to 3 m away")
    bias_m = float(np.median(wall.distance_m / np.cos(bearings_rad) - ranges_m))
    normal_rad = 0.0
    for gate_m in _GATES_M:
        secant = 1.0 / np.cos(bearings_rad - normal_rad)
        off_m = ranges_m + bias_m - wall.distance_m * secant
        used = np.abs(off_m) <= gate_m
        slope = wall.distance_m * secant * np.tan(bearings_rad - normal_rad)
        jacobian = np.column_stack((np.ones(len(off_m)), slope))[used]
        if len(jacobian) < _FEWEST:
            break
        step = np.linalg.lstsq(jacobian, off_m[used], rcond=None)[0]
        bias_m, normal_rad = bias_m - float(step[0]), normal_rad - float(step[1])
    if used.mean() < _LEAST_SHARE:
        raise CalibrationError(
            f"only {used.mean():.0%} of the readings ahead lie on a flat wall {wall.distance_m:.2f} m away: face"
            " one that is wide, flat and bare, and measure from the pan axis square to it"
        )
    variance = float((off_m[used] ** 2).sum()) / (int(used.sum()) - 2)
    error_m = math.hypot(math.sqrt(variance * np.linalg.inv(jacobian.T @ jacobian)[0, 0]), wall.distance_error_m)
    return WallFit(bias_m, error_m, normal_rad, bearings_rad[used], off_m[used])
