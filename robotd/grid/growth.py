"""Obstacles grown by a disk: C-space growth in the Euclidean metric, at the speed of a kernel.

What :func:`.footprints.dilate` does with :func:`.footprints.disk_footprint`, for whole maps and for what a change of
them can reach. [BrownDonald2000]_ sec. 2.3.2.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.grid import kernels
from robotd.grid.distance import squared_distances
from robotd.grid.window import CellWindow

_RADIUS_MAX_CELLS = 100.0
"""Growing by more takes longer than working out distances."""


def grown_by_disk(mask: NDArray[np.bool_], radius_cells: float, *, outside: bool = False) -> NDArray[np.bool_]:
    """Return the cells within a radius of a set of cells, ``bool[rows, cols]``.

    O(cells x radius) for small radii, O(cells) for great ones.

    Args:
        mask: ``bool[rows, cols]``, the set.
        radius_cells: distance between the centres of cells, not negative.
        outside: whether what lies beyond the grid is in the set.

    Raises:
        ValueError: the radius is negative.
    """
    if radius_cells > _RADIUS_MAX_CELLS:
        near: NDArray[np.bool_] = squared_distances(mask, outside=outside) <= radius_cells**2
        return near
    grown = np.empty(mask.shape, np.bool_)
    kernels.in_use().grow.grow_disk(
        mask, grown, CellWindow.whole(mask.shape), radius_cells=radius_cells, outside=outside
    )
    return grown


def grown_by_disk_updated(
    grown: NDArray[np.bool_],
    mask: NDArray[np.bool_],
    changed: CellWindow,
    radius_cells: float,
    *,
    outside: bool = False,
) -> NDArray[np.bool_]:
    """Return what :func:`grown_by_disk` returns after some cells joined or left the set, from what it was before.

    O(cells within twice the radius of the window), and a copy.

    Args:
        grown: the set as it was, grown; not changed.
        mask: the set as it is.
        changed: holds all cells that joined or left.
        radius_cells: as before.
        outside: as before.
    """
    if radius_cells > _RADIUS_MAX_CELLS:
        return grown_by_disk(mask, radius_cells, outside=outside)
    updated = grown.copy()
    # A disk reaches whole cells along rows and columns, so its radius may be rounded down.
    window = changed.grown(int(radius_cells), mask.shape)
    kernels.in_use().grow.grow_disk(mask, updated, window, radius_cells=radius_cells, outside=outside)
    return updated
