"""In which direction do walls run, to a tenth of a degree: the direction in which their points line up best.

Seen along a wall, all its points fall onto one spot. So of all directions near the one that was guessed, take that
in which the points, put into bins across it and across the direction at right angles to it, crowd most: the sum of the
squares of what the bins hold is greatest. Long walls decide, as they should; lines fitted to small surroundings, as the
guess is made of, follow the raster of the grid and the noise of the readings instead.
"""

import numpy as np
from numpy.typing import NDArray

_STEP_RAD = 0.00175
"""A tenth of a degree, what the answer is wanted to."""
_PEAK_SHARE = 0.3
"""The peak is what rises above the least by more than all but this share; its middle is less noisy than its top."""


def sharpest_direction(
    points_m: NDArray[np.float64], weights: NDArray[np.float64], near_rad: float, within_rad: float, bin_m: float = 0.05
) -> float:
    """Return the direction, modulo 90 degrees near a guess, in which points line up best.

    O(directions x points), a direction every tenth of a degree.

    Args:
        points_m: ``float64[n, 2]``, at least one.
        weights: ``float64[n]``.
        near_rad: the guess.
        within_rad: how far it may be off.
        bin_m: about the thickness of a wall as it is seen.
    """
    steps = int(within_rad / _STEP_RAD)
    directions = near_rad + _STEP_RAD * np.arange(-steps, steps + 1)
    crowding = np.array([_crowding(points_m, weights, float(direction), bin_m) for direction in directions])
    top, floor = int(crowding.argmax()), float(crowding.min())
    rise = crowding - (floor + (1.0 - _PEAK_SHARE) * (crowding[top] - floor))
    low = np.flatnonzero(rise <= 0.0)
    peak = slice(int(low[low < top].max(initial=-1)) + 1, int(low[low > top].min(initial=len(rise))))
    # All directions are alike, as those of a single point: then the guess is as good as any.
    if not rise[top] > 0.0:
        return near_rad
    return float(np.average(directions[peak], weights=rise[peak]))


def _crowding(points_m: NDArray[np.float64], weights: NDArray[np.float64], direction_rad: float, bin_m: float) -> float:
    cos, sin = np.cos(direction_rad), np.sin(direction_rad)
    squares = 0.0
    for across in ((cos, sin), (-sin, cos)):
        places = points_m @ np.array(across) / bin_m
        places -= places.min()
        bins = places.astype(np.intp)
        # Shared between two bins: nothing jumps where a wall leaves one for the next.
        later = weights * (places - bins)
        held = np.bincount(bins, weights - later, bins.max() + 2) + np.bincount(bins + 1, later, bins.max() + 2)
        squares += float(held @ held)
    return squares
