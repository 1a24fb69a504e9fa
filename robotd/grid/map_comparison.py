"""Two maps of one place beside each other: what they agree on, and how far apart their walls lie."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.distance import distance_transform
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION

FREE, UNKNOWN, OCCUPIED = 0, 1, 2


@dataclass(frozen=True, slots=True, eq=False)
class MapComparison:
    """Two maps on the cells of the first, both in one frame."""

    spec: GridSpec
    """Of the first map."""
    first: NDArray[np.uint8]
    """``uint8[rows, cols]``: ``FREE``, ``UNKNOWN`` or ``OCCUPIED``."""
    second: NDArray[np.uint8]
    """The same of the second, by its cell that holds the middle of the first's; ``UNKNOWN`` beyond it."""
    counts: NDArray[np.int64]
    """``int64[3, 3]``: cells by what they are on the first map (row) and on the second (column)."""
    first_walls_off_m: NDArray[np.float64]
    """From each wall cell of the first to the nearest of the second, ascending; infinite where that has none."""
    second_walls_off_m: NDArray[np.float64]
    """The same the other way round, walls of the second being counted on the first's cells."""

    @property
    def agreement(self) -> float | None:
        """Share of the cells seen by both that are the same on both; None if there are none."""
        seen = self.counts[::2, ::2]
        return float(np.trace(seen) / seen.sum()) if seen.sum() else None


def compare_maps(first: OccupancyGrid, second: OccupancyGrid) -> MapComparison:
    """Lay one map on another. O(cells)."""
    here, there = kinds_of(first.cells), _on(first.spec, second)
    counts = np.bincount((3 * here.astype(np.int64) + there).ravel(), minlength=9).reshape(3, 3)
    resolution_m = first.spec.resolution_m
    walls, others = here == OCCUPIED, there == OCCUPIED
    off = np.sort(distance_transform(others)[walls]) * resolution_m
    other_off = np.sort(distance_transform(walls)[others]) * resolution_m
    return MapComparison(first.spec, here, there, counts, off, other_off)


def kinds_of(cells: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return what cells are, ``uint8[rows, cols]``."""
    # As signed numbers: the difference of unsigned ones is never below 0.
    kinds: NDArray[np.uint8] = (1 + np.sign(cells.astype(np.int16) - NO_INFORMATION)).astype(np.uint8)
    return kinds


def _on(spec: GridSpec, other: OccupancyGrid) -> NDArray[np.uint8]:
    """Return another map's kinds at the middles of these cells."""
    x_m = spec.origin_x_m + (np.arange(spec.cols) + 0.5) * spec.resolution_m
    y_m = spec.origin_y_m + (np.arange(spec.rows) + 0.5) * spec.resolution_m
    # In floating point a middle may lie a hair on the wrong side of an edge, where cells of two maps share theirs.
    cols = np.floor((x_m - other.spec.origin_x_m) / other.spec.resolution_m + 1e-9).astype(np.int64)
    rows = np.floor((y_m - other.spec.origin_y_m) / other.spec.resolution_m + 1e-9).astype(np.int64)
    found = np.full(spec.shape, UNKNOWN, np.uint8)
    inside = np.ix_((rows >= 0) & (rows < other.spec.rows), (cols >= 0) & (cols < other.spec.cols))
    there = np.ix_(rows[(rows >= 0) & (rows < other.spec.rows)], cols[(cols >= 0) & (cols < other.spec.cols)])
    found[inside] = kinds_of(other.cells)[there]
    return found
