"""A sweep into the occupancy grid, in NumPy: the twin of the kernel in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.layout import Rays
from robotd.grid.ray import ray_cells
from robotd.grid.tables import UpdateTable


def insert_rays(
    cells: NDArray[np.uint8], rays: Rays, lower: UpdateTable, higher: UpdateTable, *, at_once: bool
) -> NDArray[np.intp]:
    """Change cells by two tables: those that beams run through, and those they end in.

    Args:
        cells: ``uint8[rows, cols]``, changed in place.
        rays: the beams; the cell that one ends in is not one that it runs through.
        lower: for cells that a beam runs through.
        higher: for cells that a beam ends in.
        at_once: change each cell at most once, a hit beats all misses; else one beam after the other.

    Returns:
        Flat indices of the cells whose value changed, ascending. O(beams x cells a beam).
    """
    before = cells.copy()
    passed_rays, passed = ray_cells(
        rays.starts, rays.bearings_rad, rays.lengths_cells, (cells.shape[0], cells.shape[1])
    )
    flat = cells.reshape(-1)
    if at_once:
        hit = np.unique(rays.hits[rays.hits >= 0])
        vacant = np.setdiff1d(passed, hit)
        flat[vacant] = lower[flat[vacant]]
        flat[hit] = higher[flat[hit]]
    else:
        bounds = np.searchsorted(passed_rays, np.arange(len(rays.hits) + 1))
        for ray, hit in enumerate(rays.hits):
            vacant = passed[bounds[ray] : bounds[ray + 1]]
            vacant = vacant[vacant != hit]
            flat[vacant] = lower[flat[vacant]]
            if hit >= 0:
                flat[hit] = higher[flat[hit]]
    return np.flatnonzero(cells != before)
