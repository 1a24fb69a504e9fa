"""How much readings say together: twenty beams on one near wall say one thing twenty times.

What makes a reading err, an object moved or a wall that the map has a little to the side, makes its neighbours err
alike. Readings whose heads lie near to each other therefore share one weight, and some of them can be left out.
"""

import math

import numpy as np
from numpy.typing import NDArray

from robotd.grid.readings import Readings

_COARSER = 1.15
"""Factor by which the gap is widened at each try; every try goes through all the readings."""


def spots_of(readings: Readings) -> NDArray[np.float64]:
    """Return what readings speak of, in the robot frame, ``float64[m, 2]`` [m]: their heads.

    A miss has none. It may be a dark or slanted piece of the very wall that its neighbours met, and misses side by side
    are often one such piece: it speaks of where its beam is as long as that of the hit nearest by bearing.
    """
    is_hit = readings.is_hit
    if is_hit.all() or not is_hit.any():
        return readings.heads_m
    hits = readings[is_hit]
    # Stable, here and below: readings at one bearing keep their order, and a replay chooses the same.
    hits = hits[np.argsort(hits.bearing_rad, kind="stable")]
    after = np.clip(np.searchsorted(hits.bearing_rad, readings.bearing_rad), 1, max(len(hits) - 1, 1))
    before, later = hits[after - 1], hits[np.minimum(after, len(hits) - 1)]
    is_after = np.abs(later.bearing_rad - readings.bearing_rad) < np.abs(before.bearing_rad - readings.bearing_rad)
    nearest_m = np.where(is_after, later.range_m, before.range_m)
    # No farther than the cut-off: beyond it nothing was looked at.
    range_m = np.where(is_hit, readings.range_m, np.minimum(nearest_m, readings.range_m))
    return readings.with_ranges(range_m).heads_m


def spread_out(readings: Readings, gap_m: float, most: int) -> NDArray[np.intp]:
    """Return which readings have heads at least a gap from that of the last one chosen, by bearing.

    The gap is widened until no more than ``most`` are left. O(m log m) for each gap.
    """
    # By bearing, neighbours come one after the other, so looking back at the last one chosen is enough.
    by_bearing = np.argsort(readings.bearing_rad, kind="stable")
    heads: list[tuple[float, float]] = [(x_m, y_m) for x_m, y_m in spots_of(readings[by_bearing]).tolist()]
    kept = _apart(heads, gap_m)
    while len(kept) > most:
        gap_m *= _COARSER
        kept = _apart(heads, gap_m)
    return by_bearing[kept]


def thinned(readings: Readings, gap_m: float, most: int) -> Readings:
    """Return the readings themselves that :func:`spread_out` chooses, by bearing."""
    return readings[spread_out(readings, gap_m, most)]


def weights(readings: Readings, patch_m: float) -> NDArray[np.float64]:
    """Return the weight of each reading, ``float64[m]``: one, shared with all whose heads lie within a patch.

    Sharing fades linearly to the patch's length. The sum is how many things the readings say. O(m^2).
    """
    weights: NDArray[np.float64] = 1.0 / alike(readings, patch_m).sum(axis=1)
    return weights


def alike(readings: Readings, patch_m: float) -> NDArray[np.float64]:
    """Return how far readings say the same, 0 to 1, ``float64[m, m]``."""
    heads = spots_of(readings)
    apart_m = np.hypot(heads[:, None, 0] - heads[:, 0], heads[:, None, 1] - heads[:, 1])
    return np.maximum(0.0, 1.0 - apart_m / patch_m)


def _apart(heads: list[tuple[float, float]], gap_m: float) -> list[int]:
    kept: list[int] = []
    x_m, y_m = math.inf, math.inf
    for index, head in enumerate(heads):
        if math.dist(head, (x_m, y_m)) >= gap_m:
            kept.append(index)
            x_m, y_m = head
    return kept
