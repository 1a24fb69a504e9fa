"""Walls as thick as they are drawn, and as thin as beams meet them: a thick wall is one wall, its face somewhere in it.

Maps of other programs are drawn with a broad pen, or from poses that were not as good: a wall of 5 cm comes three to
nine cells thick, to both sides of where it stands. A beam that ends where the wall is has then run through cells of it,
and is taken for blocked; of scans of buildings whose walls were drawn two cells thicker on either side, one in thirty
was found. How thick the walls are is seen from the map itself. What is more than walls usually are lies before a core
on either side: a beam may end in it, and is stopped by the core.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.grid.growth import grown_by_disk
from robotd.grid.tables import NO_INFORMATION
from robotd.grid.window import CellWindow
from robotd.localization.obstacles.thick_walls import ThickWalls

_USUAL_M = 0.1
"""Walls as thick as this are drawn where they were met: ranges and poses err by as much."""
_WALL_MAX_M = 0.6
"""What is thicker is no wall that was drawn thickly, but a solid thing; it says nothing of the pen."""
_BARELY_VACANT = np.uint8(NO_INFORMATION - 1)


@dataclass(frozen=True, slots=True, eq=False)
class WallCores:
    """How thick the walls of one map are drawn, and what is taken off them."""

    resolution_m: float
    drawn: NDArray[np.bool_]
    """``bool[rows, cols]``: the walls as the map has them."""
    read: ThickWalls
    """Where their faces are."""
    thicknesses: NDArray[np.int64]
    """How many cells of walls are how many cells thick, from 0 up to what a wall has."""

    @classmethod
    def of(cls, drawn: NDArray[np.bool_], resolution_m: float, read: ThickWalls = ThickWalls.EITHER) -> "WallCores":
        """Measure walls ``bool[rows, cols]``. O(cells)."""
        thickest = max(1, round(_WALL_MAX_M / resolution_m))
        return cls(resolution_m, drawn, read, _thicknesses(drawn, thickest, CellWindow.whole(drawn.shape)))

    def updated(self, drawn: NDArray[np.bool_], changed: CellWindow) -> "WallCores":
        """Return what :meth:`of` does for walls that differ in a window alone. O(cells within a wall's reach of it)."""
        thickest = len(self.thicknesses) - 1
        window = changed.grown(thickest, drawn.shape)
        # What the window held before is taken off, and what it holds now is added: a histogram of all would be
        # counted for each sweep.
        less, more = (_thicknesses(walls, thickest, window) for walls in (self.drawn, drawn))
        return replace(self, drawn=drawn, thicknesses=self.thicknesses + more - less)

    @property
    def depth_cells(self) -> int:
        """How many cells lie before a core on either side: none where walls are thin, or read as they are drawn."""
        if self.read is ThickWalls.AS_DRAWN:
            return 0
        summed = np.cumsum(self.thicknesses)
        # The median and not the mean: a map has a few solid blocks, which say nothing of the pen.
        median = int(np.searchsorted(summed, (summed[-1] + 1) // 2)) if summed[-1] else 0
        more_m = median * self.resolution_m - max(_USUAL_M, self.resolution_m)
        # Rounded down, but for what binary fractions lack: as little as possible is taken for the pen's.
        return max(0, int(more_m / 2.0 / self.resolution_m + 1e-9))

    @property
    def reach_cells(self) -> int:
        """How far from a changed cell others may come to lie before a core, or no longer."""
        return self.depth_cells + 1 if self.depth_cells else 0

    def before_cores(self) -> NDArray[np.bool_] | None:
        """Return the cells of walls that lie before their cores, ``bool[rows, cols]``; None if there are none.

        O(cells) where walls are thick.
        """
        depth = self.depth_cells
        return self.drawn & ~_core(self.drawn, depth) if depth else None

    def readings_of(self, cells: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], ...]:
        """Return what evidence ``uint8[rows, cols]`` may mean: what it says and, if walls are thick, only their cores.

        What lies before a core is vacant as far in as vacant ground touches the wall, else unknown. O(cells x depth).
        """
        before_cores = self.before_cores()
        if before_cores is None:
            return (cells,)
        is_faced = grown_by_disk(cells < NO_INFORMATION, float(self.depth_cells))
        cored = np.where(before_cores, np.where(is_faced, _BARELY_VACANT, NO_INFORMATION), cells)
        return cells, cored.astype(np.uint8)


def _thicknesses(walls: NDArray[np.bool_], thickest: int, window: CellWindow) -> NDArray[np.int64]:
    """Return how many wall cells of a window are 0, 1, ... ``thickest`` cells thick, along rows or columns."""
    # So far outside the window nothing is looked at: a wall that is cut off there is too thick in any case.
    seen = window.grown(thickest, walls.shape)
    rows, cols = np.nonzero(walls[seen.slices])
    height, width = seen.shape
    # A line is one cell longer here than in the map, so that no run goes on from its end to the next one.
    by_column = np.argsort(cols * (height + 1) + rows)
    thick = _runs(rows * (width + 1) + cols)
    down = np.empty_like(thick)
    down[by_column] = _runs((cols * (height + 1) + rows)[by_column])
    # The smaller of both: a wall is as long as it is one way and as thick as it is the other.
    np.minimum(thick, down, out=thick)
    rows, cols = rows + seen.first_row, cols + seen.first_col
    is_inside = (rows >= window.first_row) & (rows < window.end_row)
    is_inside &= (cols >= window.first_col) & (cols < window.end_col)
    return np.bincount(thick[is_inside & (thick <= thickest)], minlength=thickest + 1)


def _runs(places: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return how many of ascending numbers follow each other without a gap where each of them stands, ``intp[n]``."""
    begins = np.flatnonzero(np.diff(places, prepend=-2) != 1)
    lengths = np.diff(begins, append=len(places))
    return np.repeat(lengths, lengths)


def _core(walls: NDArray[np.bool_], depth: int) -> NDArray[np.bool_]:
    """Return walls less ``depth`` cells on each side, but of thinner ones their middle.

    The first steps of Lantuejoul's skeleton: what a step would take off whole stays. Two cells, as corners are farther
    from what is left than sides are, and specks there stand in the way of beams.
    """
    core, step = np.zeros_like(walls), walls
    for cells in range(1, depth + 1):
        inner = ~grown_by_disk(~walls, float(cells))
        core |= step & ~grown_by_disk(inner, 2.0)
        step = inner
    return core | step
