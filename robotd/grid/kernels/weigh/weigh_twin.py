"""Beams on a map of chances, in NumPy: the twin of the kernel in C."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.cast.cast_kernel import SKIP_MAX
from robotd.grid.kernels.weigh.weigh_kernel import AS_MAPPED, IN_UNKNOWN, IN_VACANT, UNKNOWN, ChanceMap

_ASIDE = (-math.sqrt(2.0), 0.0, math.sqrt(2.0))
_SHARE = (0.25, 0.5, 0.25)
# 2 / (pi sqrt 3): Student's t with three degrees of freedom, at its middle.
_PEAK = 0.36755259694786135
_FAR = 8.0
_STOPPED = 0.02


def weigh_beams(the_map: ChanceMap, poses: NDArray[np.float64], beams: NDArray[np.float64]) -> NDArray[np.float64]:
    """See :class:`.WeighKernel`."""
    chances = np.zeros((len(poses), len(beams), 3))
    row, col, cos, sin = (poses[:, i, None] for i in range(4))
    x, y, bearing_cos, bearing_sin, _, _, across, _ = beams.T
    row_way, col_way = sin * bearing_cos + cos * bearing_sin, cos * bearing_cos - sin * bearing_sin
    row, col = row + (sin * x + cos * y), col + (cos * x - sin * y)
    for aside, share in zip(_ASIDE, _SHARE, strict=True):
        off = aside * across
        starts = np.stack((row + off * col_way, col - off * row_way), axis=-1)
        rays = _Rays.of(starts.reshape(-1, 2), np.stack((row_way, col_way), axis=-1).reshape(-1, 2), beams)
        _follow(the_map, rays, share, chances.reshape(-1, 3))
    return chances


@dataclass(frozen=True, slots=True, eq=False)
class _Rays:
    """One ray for each beam from every pose, ``[n m]``."""

    starts: NDArray[np.float64]
    steps: NDArray[np.float64]
    pace: NDArray[np.float64]
    ranges: NDArray[np.float64]
    spread: NDArray[np.float64]
    ends: NDArray[np.float64]
    last: NDArray[np.intp]
    is_miss: NDArray[np.bool_]

    @classmethod
    def of(cls, starts: NDArray[np.float64], ways: NDArray[np.float64], beams: NDArray[np.float64]) -> "_Rays":
        longest = np.abs(ways).max(axis=1, initial=0.0)
        every = np.tile(beams, (len(ways) // max(len(beams), 1), 1))
        pace, ranges, spread, is_miss = 1.0 / longest, every[:, 4], every[:, 5], every[:, 7] > 0.0
        ends = np.where(is_miss, ranges, ranges + _FAR * spread)
        last = (ranges / pace + 0.5).astype(np.intp)
        return cls(starts, ways / longest[:, None], pace, ranges, spread, ends, last, is_miss)


def _follow(the_map: ChanceMap, rays: _Rays, share: float, chances: NDArray[np.float64]) -> None:
    """Follow all rays, each from obstacle to obstacle, and add what they say to the chances."""
    sample, left, through = np.zeros(len(rays.pace), np.intp), np.ones(len(rays.pace)), np.ones(len(rays.pace))
    passing = 1.0 - the_map.stops[UNKNOWN] * rays.pace[:, None]
    faded = np.cumprod(np.concatenate((np.ones_like(passing), np.tile(passing, SKIP_MAX)), axis=1), axis=1)
    # Rays drop out one by one, so the arrays shrink as they go instead of being masked.
    under_way = np.arange(len(rays.pace))
    while under_way.size:
        under_way = under_way[(sample * rays.pace <= rays.ends)[under_way] & (left[under_way] >= _STOPPED)]
        value, skip = _look_up(the_map, rays, under_way, sample)
        stop = the_map.stops[value]
        to_end = rays.last[under_way] - sample[under_way]
        ends_here = ~rays.is_miss[under_way] & (to_end >= 0) & (to_end < skip)
        vacant, unseen = value < UNKNOWN, value == UNKNOWN
        here = under_way[vacant & ends_here]
        chances[here, IN_VACANT] += share * left[here] * stop[vacant & ends_here]
        through[under_way[vacant]] = 1.0
        here = under_way[unseen & ends_here]
        reached = left[here] * faded[here, to_end[unseen & ends_here]]
        chances[here, IN_UNKNOWN] += share * reached * stop[unseen & ends_here]
        left[under_way[unseen]] *= faded[under_way[unseen], skip[unseen]]
        is_new = ~vacant & ~unseen & (1.0 - stop < through[under_way])
        met, passes = under_way[is_new], 1.0 - stop[is_new]
        newly = 1.0 - passes / through[met]
        through[met] = passes
        off = rays.ranges[met] - sample[met] * rays.pace[met]
        density = share * left[met] * newly * _density(off, rays.spread[met])
        chances[met, AS_MAPPED] += np.where(rays.is_miss[met], 0.0, density)
        left[met] *= 1.0 - newly
        sample[under_way] += skip
    chances[:, AS_MAPPED] += np.where(rays.is_miss, share * left, 0.0)


def _look_up(
    the_map: ChanceMap, rays: _Rays, which: NDArray[np.intp], sample: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the values of the cells in which rays are, and how far they may skip."""
    at = rays.starts[which] + sample[which, None] * rays.steps[which]
    rows, cols = the_map.cells.shape
    inside = (at[:, 0] >= 0.0) & (at[:, 1] >= 0.0) & (at[:, 0] < rows) & (at[:, 1] < cols)
    row, col = np.where(inside[:, None], at, 0.0).astype(np.intp).T
    value = np.where(inside, the_map.cells[row, col], UNKNOWN)
    return value.astype(np.intp), np.where(inside, the_map.skips[row, col], 1).astype(np.intp)


def _density(off: NDArray[np.float64], spread: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Student's t with three degrees of freedom."""
    t = off / spread
    tail = 1.0 + t * t / 3.0
    density: NDArray[np.float64] = _PEAK / (tail * tail * spread)
    return density
