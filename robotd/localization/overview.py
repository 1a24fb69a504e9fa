"""A coarse look at all poses of a map, nothing known: where is a second look worth while?

The second look (:mod:`.second_look`) moves every start uphill, so a start need not be at the right cell. Counting on
cells twice as large, at headings three times as far apart, takes a twelfth of the time; of readings on one piece of
wall one is enough. On two real buildings (5 cm cells, 100 kept-out scans each) the right place was among the first 100
starts every time, and the first one in 87 to 96 of 100.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading
from robotd.grid.readings import numbers_of
from robotd.grid.spec import GridSpec
from robotd.grid.ternary import TernaryMap
from robotd.localization.obstacles import Obstacles, UnknownCells
from robotd.localization.patches import spread_out
from robotd.localization.prepared import PreparedMap
from robotd.localization.rank import RankGrid, bits_of, even_headings

_MEMORY_BYTES = 1 << 28
"""256 MiB of counters at a time."""
_POSES_AT_ONCE = 1 << 18
"""More poses of the same batch and rank than this are too many to tell."""
_LEAST_SHARE = 0.5
"""Poses that explain less than this share of what the best one does are no starts."""


@dataclass(frozen=True, slots=True)
class OverviewSettings:
    """How coarse a look at all poses is."""

    cell_m: float = 0.1
    """Cells are put together up to about this size."""
    error_cells: float = 1.0
    """The paper's eps, in such cells."""
    headings: int = 360
    """Headings that are tried, evenly all round."""
    readings_max: int = 60
    """Of more readings than this so many are counted, those that end farthest apart ..."""
    gap_m: float = 0.2
    """... and none that end nearer to each other than this."""
    poses_max: int = 4000
    """The poses that explain most readings are wanted, but not more than so many."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        for name in ("cell_m", "gap_m"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")
        if not self.error_cells >= 0.0:
            raise ValueError(f"error_cells must not be negative, got {self.error_cells}")
        for name in ("headings", "readings_max", "poses_max"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 1, got {getattr(self, name)}")


@dataclass(frozen=True, slots=True, eq=False)
class Starts:
    """Poses that explain much, coarsely."""

    poses: NDArray[np.float64]
    """``float64[n, 3]``: x, y [m] and heading [rad], map frame."""
    ranks: NDArray[np.intp]
    """``intp[n]``: how many of ``readings`` each explains."""
    readings: int
    is_all: bool
    """Whether these are all that explain so many; else too many do to tell, and these are at most some of them, evenly
    chosen: then it is open where the robot is."""


@dataclass(frozen=True, slots=True, eq=False)
class Overview:
    """A map, made coarse; made once for all readings."""

    coarse: PreparedMap
    settings: OverviewSettings

    @classmethod
    def of(cls, ternary: TernaryMap, settings: OverviewSettings) -> "Overview":
        """Prepare a map. O(cells).

        Unknown cells stop beams, and end none; two obstacle cells must be met to stop one: one by one, larger cells
        would close doors and block whatever grazes a wall.
        """
        pooled_map = pooled(ternary, max(1, round(settings.cell_m / ternary.spec.resolution_m)))
        obstacles = Obstacles.of_map(pooled_map, UnknownCells.BLOCKS_ONLY, settings.error_cells, blocked_by=2)
        return cls(PreparedMap.of(obstacles, pooled_map.spec, settings.error_cells), settings)

    def starts(self, readings: Sequence[RangeReading], *, threads: int = 1) -> Starts:
        """Return where to look again; the same for any number of threads.

        Raises:
            ValueError: a reading measured nothing.
        """
        chosen = self._chosen(readings)
        poses, counts, too_many = np.zeros((0, 3)), np.zeros(0, np.intp), False
        for headings_rad in self._batches(len(chosen)):
            ranks = RankGrid(self.coarse, headings_rad, threads=threads)
            ranks.add(*chosen)
            least = _least_rank(ranks, self.settings.poses_max)
            if ranks.count_of_rank(least) > _POSES_AT_ONCE:
                too_many = True
                continue
            cells = ranks.cells_of_rank(least)
            poses = np.concatenate((poses, self._in_metres(cells, headings_rad)))
            counts = np.concatenate((counts, ranks.rank_at(cells).astype(np.intp)))
        kept = _best_of(counts, self.settings.poses_max)
        is_all = int((counts >= counts[kept].min(initial=0)).sum()) == len(kept) and not too_many
        return Starts(poses[kept], counts[kept], len(chosen), is_all)

    def _chosen(self, readings: Sequence[RangeReading]) -> list[RangeReading]:
        numbers = numbers_of(readings)
        return [readings[index] for index in spread_out(numbers, self.settings.gap_m, self.settings.readings_max)]

    def _batches(self, readings: int) -> list[tuple[float, ...]]:
        """Return the headings in batches whose counters take no more than the memory for them."""
        headings_rad = even_headings(self.settings.headings)
        size = max(1, _MEMORY_BYTES // max(1, self.coarse.packed.counter_bytes(1, bits_of(readings))))
        return [headings_rad[first : first + size] for first in range(0, len(headings_rad), size)]

    def _in_metres(self, poses: NDArray[np.intp], headings_rad: tuple[float, ...]) -> NDArray[np.float64]:
        spec = self.coarse.spec
        x_m = spec.origin_x_m + (poses[:, 2] + 0.5) * spec.resolution_m
        y_m = spec.origin_y_m + (poses[:, 1] + 0.5) * spec.resolution_m
        return np.stack((x_m, y_m, np.array(headings_rad)[poses[:, 0]]), axis=1)


def _least_rank(ranks: RankGrid, most: int) -> int:
    """Return the least rank, not too far from the best, that no more than so many poses have; else the best."""
    too_low, high_enough = max(0, math.ceil(_LEAST_SHARE * ranks.best_rank) - 1), max(1, ranks.best_rank)
    while high_enough - too_low > 1:
        middle = (too_low + high_enough) // 2
        if ranks.count_of_rank(middle) > most:
            too_low = middle
        else:
            high_enough = middle
    return high_enough


def _best_of(counts: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """Return which poses to keep, ascending: all down to a rank, or some of the best ones, evenly chosen."""
    best = int(counts.max(initial=0))
    for least in range(max(1, math.ceil(_LEAST_SHARE * best)), best + 1):
        kept = np.flatnonzero(counts >= least)
        if len(kept) <= most:
            return kept
    kept = np.flatnonzero(counts == best)
    return kept[:: max(1, -(-len(kept) // most))]


def pooled(ternary: TernaryMap, factor: int) -> TernaryMap:
    """Return a map of larger cells: occupied if any cell in one is, else vacant if any is, else unknown. O(cells)."""
    if factor == 1:
        return ternary
    spec = ternary.spec
    rows, cols = -(-spec.rows // factor), -(-spec.cols // factor)
    larger = GridSpec(spec.resolution_m * factor, spec.origin_x_m, spec.origin_y_m, (rows, cols))
    occupied = _any(ternary.occupied, factor)
    return TernaryMap(larger, occupied, _any(ternary.vacant, factor) & ~occupied)


def _any(cells: NDArray[np.bool_], factor: int) -> NDArray[np.bool_]:
    rows, cols = cells.shape
    padded = np.pad(cells, ((0, -rows % factor), (0, -cols % factor)))
    blocks = padded.reshape(padded.shape[0] // factor, factor, -1, factor)
    return np.asarray(blocks.any(axis=(1, 3)))
