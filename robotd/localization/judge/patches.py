"""How much readings say together: twenty beams on one near wall say one thing twenty times.

What makes a reading err, an object moved or a wall that the map has a little aside, makes its neighbours err alike.
Readings whose heads lie near to each other therefore share one weight, and some of them can be left out.
"""

import math

import numpy as np
from numpy.typing import NDArray

_COARSER = 1.15


def heads_of(readings: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where readings ``float64[m, 5]`` end, in the robot frame, ``float64[m, 2]`` [m]."""
    bearing_rad, range_m, x_m, y_m, _ = readings.T
    return np.stack((x_m + range_m * np.cos(bearing_rad), y_m + range_m * np.sin(bearing_rad)), axis=1)


def spots_of(readings: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what readings ``float64[m, 5]`` speak of, in the robot frame, ``float64[m, 2]`` [m]: their heads.

    A miss has none. It may be a dark or slanted piece of the very wall that its neighbours met, and misses side by side
    are often one such piece: it speaks of where its beam is as long as that of the hit nearest by bearing.
    """
    is_hit = readings[:, 4] == 0.0
    if is_hit.all() or not is_hit.any():
        return heads_of(readings)
    hits = readings[is_hit][np.argsort(readings[is_hit, 0], kind="stable")]
    after = np.clip(np.searchsorted(hits[:, 0], readings[:, 0]), 1, max(len(hits) - 1, 1))
    before, after = hits[after - 1], hits[np.minimum(after, len(hits) - 1)]
    is_after = np.abs(after[:, 0] - readings[:, 0]) < np.abs(before[:, 0] - readings[:, 0])
    spoken_of = readings.copy()
    nearest_m = np.where(is_after, after[:, 1], before[:, 1])
    spoken_of[:, 1] = np.where(is_hit, readings[:, 1], np.minimum(nearest_m, readings[:, 1]))
    return heads_of(spoken_of)


def spread_out(readings: NDArray[np.float64], gap_m: float, most: int) -> NDArray[np.intp]:
    """Return which of ``float64[m, 5]`` have heads at least a gap from that of the last one chosen, by bearing.

    The gap is widened until no more than ``most`` are left. O(m log m) for each gap.
    """
    by_bearing = np.argsort(readings[:, 0], kind="stable")
    heads: list[tuple[float, float]] = [(x_m, y_m) for x_m, y_m in spots_of(readings[by_bearing]).tolist()]
    kept = _apart(heads, gap_m)
    while len(kept) > most:
        gap_m *= _COARSER
        kept = _apart(heads, gap_m)
    return by_bearing[kept]


def thinned(readings: NDArray[np.float64], gap_m: float, most: int) -> NDArray[np.float64]:
    """Return the readings themselves that :func:`spread_out` chooses, by bearing."""
    return readings[spread_out(readings, gap_m, most)]


def weights(readings: NDArray[np.float64], patch_m: float) -> NDArray[np.float64]:
    """Return the weight of each reading of ``float64[m, 5]``: one, shared with all whose heads lie within a patch.

    Sharing fades linearly to the patch's length. The sum is how many things the readings say. O(m^2).
    """
    weights: NDArray[np.float64] = 1.0 / alike(readings, patch_m).sum(axis=1)
    return weights


def alike(readings: NDArray[np.float64], patch_m: float) -> NDArray[np.float64]:
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
