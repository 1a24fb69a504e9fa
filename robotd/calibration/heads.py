"""The heads of one sweep's hits, and the walls that they lie along."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import CalibrationError
from robotd.core.reading import ReadingStatus, Sweep

_NEIGHBOURS = 12
"""Heads that say which way a wall runs: 300 readings at 3 m lie 6 cm apart, with errors of a few cm."""
_NEAR_M = 0.6
_FLAT_M = 0.05
"""Neighbours that scatter more than this about their line are no wall: a corner, a plant."""
_FEWEST = 5
FEWEST_HEADS = 30
"""Of fewer nothing is concluded."""


@dataclass(frozen=True, slots=True, eq=False)
class SweepHeads:
    """Where the readings of a sweep met something, in the robot frame of that sweep."""

    at_m: NDArray[np.float64]
    """``float64[n, 2]``: x, y, in the order of the bearings."""
    ahead: NDArray[np.float64]
    """``float64[n, 2]``: the way the beam went there, of length 1."""
    foot_m: NDArray[np.float64]
    """``float64[n, 2]``: a point of the wall that each lies along."""
    normal: NDArray[np.float64]
    """``float64[n, 2]``: of that wall, of length 1."""
    is_wall: NDArray[np.bool_]
    """``bool[n]``: whether its neighbours lie along a line."""

    @classmethod
    def of(
        cls, bearings_rad: NDArray[np.float64], ranges_m: NDArray[np.float64], origins_m: NDArray[np.float64]
    ) -> "SweepHeads":
        """Take hits: ``float64[n]`` bearings from the heading, ranges, and where the beams start, ``float64[n, 2]``.

        Raises:
            CalibrationError: there are too few to conclude anything.
        """
        if len(ranges_m) < FEWEST_HEADS:
            raise CalibrationError(f"only {len(ranges_m)} readings met a wall; at least {FEWEST_HEADS} must")
        order = np.argsort(bearings_rad)
        ahead = np.stack((np.cos(bearings_rad[order]), np.sin(bearings_rad[order])), axis=1)
        at_m = origins_m[order] + ranges_m[order, None] * ahead
        return cls(at_m, ahead, *_walls(at_m))

    @classmethod
    def of_sweep(cls, sweep: Sweep) -> "SweepHeads":
        """Take the hits of a sweep; CalibrationError if there are too few."""
        hits = [reading for reading in sweep.readings if reading.status is ReadingStatus.OK]
        return cls.of(
            np.array([reading.bearing_rad for reading in hits]),
            np.array([reading.range_m for reading in hits], np.float64),
            np.array([(reading.origin_x_m, reading.origin_y_m) for reading in hits]).reshape(-1, 2),
        )


def _walls(at_m: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Return foot, normal and flatness of the line through the nearest heads of each: its principal axes."""
    apart = np.linalg.norm(at_m[:, None] - at_m[None], axis=2)
    nearest = np.argsort(apart, axis=1)[:, :_NEIGHBOURS]
    weight = (np.take_along_axis(apart, nearest, axis=1) <= _NEAR_M).astype(np.float64)
    around = at_m[nearest]
    foot_m = (weight[:, :, None] * around).sum(axis=1) / weight.sum(axis=1)[:, None]
    off = (around - foot_m[:, None]) * np.sqrt(weight)[:, :, None]
    scatter = np.einsum("nki,nkj->nij", off, off) / weight.sum(axis=1)[:, None, None]
    # Principal axes and not a fit of y by x: a wall may run in any direction.
    variances, axes = np.linalg.eigh(scatter)
    normal = axes[:, :, 0]
    thick_m, long_m = np.sqrt(np.maximum(variances, 0.0)).T
    # Long as well as thin: a handful of heads on a table leg lie on a line of any direction.
    is_wall = (weight.sum(axis=1) >= _FEWEST) & (thick_m <= _FLAT_M) & (long_m >= 2.0 * thick_m)
    return foot_m, normal, is_wall
