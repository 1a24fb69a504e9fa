"""Where the robot's centre may be: free cells, less obstacles grown by the robot ([BrownDonald2000]_ sec. 2.3.2).

What is not known to be free is an obstacle, with two exceptions that any real sweep needs:

- **gaps**: far from a stop, neighbouring beams leave wedges of cells that none of them met;
- **strays**: one wrong range leaves one occupied cell in the open. An occupied cell that touches no other, with no
  more evidence than one hit gives, counts as never seen until a second stop confirms it.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.binary import FREE_MAX
from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION, raise_table

_NEIGHBOURS = np.array([[True, True, True], [True, False, True], [True, True, True]])


def free_cells(grid: OccupancyGrid, gap_cells: int) -> NDArray[np.bool_]:
    """Return the cells taken for free, ``bool[rows, cols]``: seen free, or in a gap that is narrow enough.

    Only cells never seen and strays are filled in, so no wall is eaten; and where a wall has a gap, the wall on either
    side of it is grown over the gap by the robot's radius.

    Args:
        grid: the map.
        gap_cells: width of the widest gap to close, 0 for none.
    """
    seen_free = grid.cells <= FREE_MAX
    open_to_doubt = (grid.cells == NO_INFORMATION) | strays(grid)
    free: NDArray[np.bool_] = seen_free | (open_to_doubt & closed(seen_free, gap_cells))
    return free


def strays(grid: OccupancyGrid) -> NDArray[np.bool_]:
    """Return the occupied cells that a single wrong range may have left, ``bool[rows, cols]``."""
    occupied = grid.cells > NO_INFORMATION
    hit_once = raise_table(grid.settings.raise_alpha)[NO_INFORMATION]
    stray: NDArray[np.bool_] = occupied & (grid.cells <= hit_once) & ~dilate(occupied, _NEIGHBOURS)
    return stray


def closed(mask: NDArray[np.bool_], gap_cells: int) -> NDArray[np.bool_]:
    """Return a set with its narrow gaps filled (morphological closing), ``bool[rows, cols]``.

    A cell outside the set is filled if no square of ``gap_cells + 1`` cells a side that holds it misses the set; the
    square may reach beyond the grid, where nothing is in the set.
    """
    side = gap_cells + 1
    corner = np.zeros((2 * gap_cells + 1,) * 2, np.bool_)
    corner[:side, :side] = True
    touching = dilate(np.pad(mask, gap_cells), corner)
    open_ground = dilate(~touching, corner[::-1, ::-1])
    return ~open_ground[gap_cells : gap_cells + mask.shape[0], gap_cells : gap_cells + mask.shape[1]]


def inflated(obstacles: NDArray[np.bool_], radius_cells: float) -> NDArray[np.bool_]:
    """Return the C-space obstacles of a disk, ``bool[rows, cols]``; what lies outside the grid is an obstacle."""
    return dilate(obstacles, disk_footprint(radius_cells), outside=True)
