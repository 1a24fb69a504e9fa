"""How likely are readings somewhere that is not on the map?

Every place of a map explains something of any sweep: there are walls everywhere, and a wall is soon laid on another.
So a place has to explain more than is known about rooms without a map: **walls go on straight**, and open space goes
on, too. Reading after reading by bearing, either the wall of the last two goes on, or something else stands there, at
a rate as where nobody has looked, or the reading means nothing. What the map knows beyond that is where walls end and
begin, and how far off they are: that is what its places are recognized by.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid.readings import Readings
from robotd.localization.judge.error_model import ErrorModel

_GOES_ON = 0.6
"""Chance that the wall of the last two heads goes on to the next one; or that a miss follows a miss."""
_ROUGHNESS_M = 0.02
"""How far walls are from straight."""
_FARTHEST = 4.0
"""A wall goes on no farther than this many times the distance between its two heads."""
_SINE_MIN = 0.05
"""Walls that are met more aslant than this are met anywhere."""
_PEAK = 0.36755259694786135
"""Of Student's t with three degrees of freedom."""


@dataclass(frozen=True, slots=True, eq=False)
class GoingOn:
    """What is expected of ``m`` readings, by bearing, if for each the wall of the two before it goes on."""

    is_wall: NDArray[np.bool_]
    """``bool[m]``: whether there are two before it that make a wall which it can meet."""
    heads_m: NDArray[np.float64]
    """``float64[m, 2]``: where it then ends, robot frame."""
    densities: NDArray[np.float64]
    """``float64[m]``: of its range, if it does [1/m]."""


def elsewhere(readings: Readings, model: ErrorModel, going_on: GoingOn) -> NDArray[np.float64]:
    """Return how likely each reading is, given those before it, somewhere in any building.

    Args:
        readings: ``m`` of them, by bearing.
        model: how readings err.
        going_on: what is expected of them.

    Returns:
        ``float64[m]``: for hits the density [1/m], for misses the chance; without those that mean nothing.
    """
    is_hit = readings.is_hit
    known = model.anywhere(readings.range_m, is_hit)
    # Open space goes on as walls do: a hundred misses through one large door are not a hundred surprises.
    stays_open = np.flatnonzero(~is_hit[1:] & ~is_hit[:-1]) + 1
    known[stays_open] = _GOES_ON + (1.0 - _GOES_ON) * known[stays_open]
    return or_going_on(known, going_on.densities, _GOES_ON * going_on.is_wall)


def or_going_on(
    otherwise: NDArray[np.float64], densities: NDArray[np.float64], chances: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return densities of readings, ``float64[..., m]``, if walls go on by chance, and else they are otherwise."""
    either: NDArray[np.float64] = chances * densities + (1.0 - chances) * otherwise
    return either


def going_on(readings: Readings, model: ErrorModel) -> GoingOn:
    """Return where each reading ends, and how it scatters, if the wall of the two before it, by bearing, goes on."""
    found = GoingOn(np.zeros(len(readings), np.bool_), np.zeros((len(readings), 2)), np.zeros(len(readings)))
    if len(readings) < 3:
        return found
    heads, is_hit, ahead = readings.heads_m, readings.is_hit, readings[2:]
    wall, last = heads[1:-1] - heads[:-2], heads[1:-1]
    # Two heads in one place make no wall, but must not divide by nothing either.
    length = np.maximum(np.hypot(wall[:, 0], wall[:, 1]), 1e-9)
    way = np.stack((np.cos(ahead.bearing_rad), np.sin(ahead.bearing_rad)), axis=1)
    aslant = way[:, 0] * wall[:, 1] - way[:, 1] * wall[:, 0]
    # Bounded and with its sign: a beam nearly along the wall meets it anywhere, but on the right side.
    aslant = np.where(np.abs(aslant) < _SINE_MIN * length, np.copysign(_SINE_MIN * length, aslant), aslant)
    starts = ahead.rows[:, 2:4]
    to_last = last - starts
    expected_m = (to_last[:, 0] * wall[:, 1] - to_last[:, 1] * wall[:, 0]) / aslant
    found.heads_m[2:] = starts + expected_m[:, None] * way
    beyond = found.heads_m[2:] - last
    farther = np.hypot(beyond[:, 0], beyond[:, 1]) / length
    # The line through two heads errs by both of them, the more the farther it is drawn on.
    error_m = np.sqrt(model.range_sigma_m**2 * (1.0 + (1.0 + farther) ** 2 + farther**2) + _ROUGHNESS_M**2)
    spread_m = error_m * length / np.abs(aslant)
    # Student's t and no normal curve: where a wall has a niche, one reading far off must not outweigh all
    # others.
    tail = 1.0 + ((ahead.range_m - expected_m) / spread_m) ** 2 / 3.0
    found.densities[2:] = _PEAK / (tail * tail * spread_m)
    found.is_wall[2:] = is_hit[2:] & is_hit[1:-1] & is_hit[:-2] & (expected_m > 0.0) & (farther < _FARTHEST)
    return found
