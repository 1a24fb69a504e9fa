"""Growing by a disk, in NumPy: the twin of the kernel in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.window import CellWindow


def grow_disk(
    mask: NDArray[np.bool_], grown: NDArray[np.bool_], window: CellWindow, *, radius_cells: float, outside: bool
) -> None:
    """See :class:`.GrowKernel`."""
    disk = disk_footprint(radius_cells)
    seen = window.grown(disk.shape[0] // 2, mask.shape)
    row, col = window.first_row - seen.first_row, window.first_col - seen.first_col
    inner = (slice(row, row + window.shape[0]), slice(col, col + window.shape[1]))
    # Beyond a part of the grid, too, cells count as outside; they are out of the window's reach.
    grown[window.slices] = dilate(mask[seen.slices], disk, outside=outside)[inner]
