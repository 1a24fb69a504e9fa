"""Beams on a map of chances, in NumPy: the twin of the kernel in C.

A cell does not stop a beam or let it through: it stops it with a chance that its evidence gives. A beam that is
followed through the map is thinned cell by cell, and what is taken from it in a cell is the chance that it ends there.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.endings import AS_MAPPED, IN_UNKNOWN, IN_VACANT

_UNKNOWN = 128
_ASIDE = (-math.sqrt(2.0), 0.0, math.sqrt(2.0))
_SHARE = (0.25, 0.5, 0.25)
_PEAK = 0.36755259694786135
_FAR = 8.0
_STOPPED = 1e-4


def weigh_beams(
    cells: NDArray[np.uint8], stops: NDArray[np.float64], poses: NDArray[np.float64], beams: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return how likely each beam ended where it did, seen from each pose.

    A beam is sampled as in :mod:`robotd.grid.ray`. Where it meets an obstacle is blurred by Student's t with three
    degrees of freedom along the beam, and across it by three parallel beams, which have its variance.
    Obstacle cells side by side are one obstacle, as likely to be there as the likeliest of them.

    Args:
        cells: the map, ``uint8[rows, cols]``; what lies outside was never seen.
        stops: ``float64[256]``: the chance that a cell of this value stops a beam, for obstacles, below 1; for others
            the chance for each cell's length of way.
        poses: ``float64[n, 4]``: row, column, cosine and sine of the heading, in cells.
        beams: ``float64[m, 8]``: x and y of the start in the robot frame, cosine and sine of the bearing, the range,
            its standard deviation along and across the beam, all in cells, and 1 for a miss, 0 for a hit.

    Returns:
        ``float64[n, m, 3]``: for a hit the density [1 / cell] of its range by where it ends; for a miss the
        chance that nothing stops it, and two zeros. O(n m length).
    """
    chances = np.zeros((len(poses), len(beams), 3))
    row, col, cos, sin = (poses[:, i, None] for i in range(4))
    x, y, bearing_cos, bearing_sin, _, _, across, _ = beams.T
    row_way, col_way = sin * bearing_cos + cos * bearing_sin, cos * bearing_cos - sin * bearing_sin
    row, col = row + (sin * x + cos * y), col + (cos * x - sin * y)
    for aside, share in zip(_ASIDE, _SHARE, strict=True):
        off = aside * across
        rays = _Rays(row + off * col_way, col - off * row_way, row_way, col_way, share)
        _follow(cells, stops, beams, rays, chances)
    return chances


@dataclass(frozen=True, slots=True, eq=False)
class _Rays:
    """One ray for each beam from every pose: where it starts, where to, and the beam's share that it stands for."""

    row: NDArray[np.float64]
    col: NDArray[np.float64]
    row_way: NDArray[np.float64]
    col_way: NDArray[np.float64]
    share: float


def _follow(
    cells: NDArray[np.uint8],
    stops: NDArray[np.float64],
    beams: NDArray[np.float64],
    rays: _Rays,
    chances: NDArray[np.float64],
) -> None:
    """Follow rays sample after sample, and add what they say to the chances."""
    longest = np.maximum(np.abs(rays.row_way), np.abs(rays.col_way))
    pace = 1.0 / longest
    is_miss = np.broadcast_to(beams[:, 7] > 0.0, pace.shape)
    ranges, spread = beams[:, 4], beams[:, 5]
    end = np.where(is_miss, ranges, ranges + _FAR * spread)
    left, through = np.ones(pace.shape), np.ones(pace.shape)
    for k in range(int((end / pace).max(initial=0.0)) + 2):
        under_way = (k * pace <= end) & (left >= _STOPPED)
        if not under_way.any():
            break
        value = _values(cells, rays.row + k * (rays.row_way / longest), rays.col + k * (rays.col_way / longest))
        is_wall, off = value > _UNKNOWN, ranges - k * pace
        passes = 1.0 - stops[value]
        newly = is_wall & (passes < through)
        stop = np.where(is_wall, np.where(newly, 1.0 - passes / through, 0.0), stops[value] * pace)
        through = np.where(newly & under_way, passes, np.where((value < _UNKNOWN) & under_way, 1.0, through))
        counts = under_way & ~is_miss
        ends_here = counts & ~is_wall & (np.abs(off) <= 0.5 * pace)
        chances[..., AS_MAPPED] += np.where(counts & is_wall, rays.share * left * stop * _density(off, spread), 0.0)
        chances[..., IN_UNKNOWN] += np.where(ends_here & (value == _UNKNOWN), rays.share * left * stop / pace, 0.0)
        chances[..., IN_VACANT] += np.where(ends_here & (value < _UNKNOWN), rays.share * left * stop / pace, 0.0)
        left = np.where(under_way, left * (1.0 - stop), left)
    chances[..., AS_MAPPED] += np.where(is_miss, rays.share * left, 0.0)


def _values(cells: NDArray[np.uint8], row: NDArray[np.float64], col: NDArray[np.float64]) -> NDArray[np.uint8]:
    rows, cols = cells.shape
    inside = (row >= 0.0) & (col >= 0.0) & (row < rows) & (col < cols)
    row, col = np.where(inside, row, 0.0), np.where(inside, col, 0.0)
    return np.where(inside, cells[row.astype(np.intp), col.astype(np.intp)], _UNKNOWN).astype(np.uint8)


def _density(off: NDArray[np.float64], spread: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Student's t with three degrees of freedom."""
    t = off / spread
    tail = 1.0 + t * t / 3.0
    density: NDArray[np.float64] = _PEAK / (tail * tail * spread)
    return density
