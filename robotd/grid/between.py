"""What two beams side by side saw together: the ground between them, up to where the nearer one ended.

Beams of one stop part from each other: at 12 m, two of 300 leave 25 cm between them, five cells. No beam crossed those,
so a map that counts only what was crossed is full of holes, and every other beam through a hole is taken for blocked:
a hall was lost in its middle, and a room mapped from two stops lost to its likeness mapped from four. What would stand
in such a hole and be met by neither beam is narrower than they are apart. So cells that were never seen and lie between
two beams are taken as seen through. Only those: a table leg that an earlier stop has hit stays.
"""

import math

import numpy as np

from robotd.grid.readings import Readings

APART_MAX_RAD = math.radians(2.5)
"""Beams farther apart than this say nothing of what lies between them: a chair fits in at 10 m."""
MARGIN_CELLS = 2.0
"""How far before the nearer end the ground is taken as seen: a wall that is hit in spots must not get gaps."""
_FULL = 0.5
"""Share of the way to there from which on the ground is filled: cells are square, and beams are not where cells are."""
_BEAMS_PER_CELL = 2.0
"""As close together as this, no cell between two beams is missed, however they lie to the axes."""


def between(readings: Readings, resolution_m: float) -> Readings:
    """Return beams that fill the gaps between the beams of one stop, as misses.

    Args:
        readings: in any order.
        resolution_m: side of a cell; beams are filled in until two lie in each cell where they end.
    """
    # By bearing: a head that sweeps to and fro brings them in another order, and neighbours are what counts.
    order = np.argsort(readings.bearing_rad, kind="stable")
    one = readings.rows[order]
    other = np.concatenate((one[1:], one[:1]))
    # The last is beside the first: a sweep goes round.
    apart_rad = np.mod(other[:, 0] - one[:, 0], 2 * math.pi)
    # Nearer than where they are a cell apart, the beams themselves have crossed every cell between them.
    begin_m = resolution_m / np.maximum(apart_rad, 1e-9)
    end_m = np.minimum(one[:, 1], other[:, 1]) - MARGIN_CELLS * resolution_m
    pair = np.flatnonzero((apart_rad > 0.0) & (apart_rad <= APART_MAX_RAD) & (end_m > begin_m))
    parts = np.ceil(_BEAMS_PER_CELL * apart_rad[pair] * end_m[pair] / resolution_m)  # 3 or more: they are cells apart
    added = parts.astype(int) - 1
    pair, parts, first = (np.repeat(column, added) for column in (pair, parts, np.cumsum(added) - added))
    share = (np.arange(1, len(pair) + 1) - first) / parts
    begin_m, bearing_rad = _FULL * begin_m.take(pair), one[:, 0].take(pair) + share * apart_rad.take(pair)
    # `take` of whole rows is four times as fast as an index of some columns.
    nearer = one.take(pair, axis=0)
    filled = nearer + share[:, None] * (other.take(pair, axis=0) - nearer)
    filled[:, 0] = bearing_rad
    filled[:, 1] = end_m.take(pair) - begin_m
    filled[:, 2] += begin_m * np.cos(bearing_rad)
    filled[:, 3] += begin_m * np.sin(bearing_rad)
    filled[:, 4] = 1.0
    return Readings(filled)
