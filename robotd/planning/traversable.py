"""Where the robot's centre may be: free cells, less obstacles grown by the robot ([BrownDonald2000]_ sec. 2.3.2).

What is not known to be free is an obstacle, with one exception that any real sweep needs, **gaps**: far from a stop,
neighbouring beams leave wedges of cells that none of them met. One hit is enough: the leg of a table is one cell, hit
by one beam, and looks like a wrong range. Either is an obstacle until a later sweep sees through it. Only where that
leaves no way at all, lone hits may be doubted.
"""

import math

import numpy as np
from numpy.typing import NDArray

from robotd.grid.binary import FREE_MAX
from robotd.grid.footprints import dilate, disk_footprint, touching_footprint
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION, raise_table

# Without the middle: a hit does not keep itself company.
_NEIGHBOURS = np.array([[True, True, True], [True, False, True], [True, True, True]])
_TO_THE_CORNER = math.sqrt(0.5) + 1e-6
"""No point of a cell is farther from its centre [cells]; the rest is for rounding."""


def free_cells(grid: OccupancyGrid, gap_cells: int, doubted: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
    """Return the cells taken for free, ``bool[rows, cols]``: seen free, or in a gap that is narrow enough.

    Only cells never seen, and doubted ones, are filled in, so no wall is eaten; and where a wall has a gap, the wall on
    either side of it is grown over the gap by the robot's radius.

    Args:
        grid: the map.
        gap_cells: width of the widest gap to close, 0 for none.
        doubted: ``bool[rows, cols]``, cells that count as never seen.
    """
    seen_free = grid.cells <= FREE_MAX
    unseen = grid.cells == NO_INFORMATION if doubted is None else (grid.cells == NO_INFORMATION) | doubted
    free: NDArray[np.bool_] = seen_free | (unseen & closed(seen_free, gap_cells))
    return free


def lone_hits(grid: OccupancyGrid, hit: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the cells that a single wrong range may have left, ``bool[rows, cols]``.

    They touch no other obstacle, and have no more evidence than one hit gives.

    Args:
        grid: the map.
        hit: ``bool[rows, cols]``, cells hit since they were last seen free.
    """
    occupied = (grid.cells > NO_INFORMATION) | hit
    # From never seen upwards: a second hit leaves a greater value, and is no longer a lone one.
    hit_once = raise_table(grid.settings.raise_alpha)[NO_INFORMATION]
    lone: NDArray[np.bool_] = occupied & (grid.cells <= hit_once) & ~dilate(occupied, _NEIGHBOURS)
    return lone


def closed(mask: NDArray[np.bool_], gap_cells: int) -> NDArray[np.bool_]:
    """Return a set with its narrow gaps filled (morphological closing), ``bool[rows, cols]``.

    A cell outside the set is filled if no square of ``gap_cells + 1`` cells a side that holds it misses the set; the
    square may reach beyond the grid, where nothing is in the set.
    """
    side = gap_cells + 1
    # A square of any width hung into a footprint that has a middle, which `dilate` needs.
    corner = np.zeros((2 * gap_cells + 1,) * 2, np.bool_)
    corner[:side, :side] = True
    touching = dilate(np.pad(mask, gap_cells), corner)
    # Where no square begun at a cell meets the set; mirrored, the footprint lays those squares over their cells.
    open_ground = dilate(~touching, corner[::-1, ::-1])
    return ~open_ground[gap_cells : gap_cells + mask.shape[0], gap_cells : gap_cells + mask.shape[1]]


def inflated(obstacles: NDArray[np.bool_], robot_cells: float, clearance_cells: float) -> NDArray[np.bool_]:
    """Return where the robot's centre may not be, ``bool[rows, cols]``; what lies outside the grid is an obstacle.

    From any point of a cell that is left, not only from its centre, the robot's disk meets no obstacle's square,
    however small the clearance; and the centres of obstacles are farther from its own than robot and clearance.

    Args:
        obstacles: ``bool[rows, cols]``.
        robot_cells: radius of the disk that the robot fills.
        clearance_cells: what to keep free round it besides.
    """
    reach = touching_footprint(robot_cells + _TO_THE_CORNER)
    disk = disk_footprint(robot_cells + clearance_cells)
    return dilate(obstacles, reach, outside=True) | dilate(obstacles, disk, outside=True)
