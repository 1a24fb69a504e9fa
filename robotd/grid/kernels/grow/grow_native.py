"""Growing by a disk, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.footprints import disk_footprint
from robotd.grid.kernels.shared.library import ffi, lib, octets
from robotd.grid.window import CellWindow

_REACH_MAX = 254
"""Ways are counted in bytes."""


def grow_disk(
    mask: NDArray[np.bool_], grown: NDArray[np.bool_], window: CellWindow, *, radius_cells: float, outside: bool
) -> None:
    """See :class:`.GrowKernel`.

    Raises:
        ValueError: the radius is negative or more than 254 cells, or ``grown`` is read-only.
    """
    disk = disk_footprint(radius_cells)
    reach = disk.shape[0] // 2
    if reach > _REACH_MAX:
        raise ValueError(f"radius_cells must be less than {_REACH_MAX + 1}, got {radius_cells}")
    if window.is_empty:
        return
    heights = ((disk.sum(axis=0) - 1) // 2).astype(np.uint8)
    height, width = window.shape
    cells, ways = np.ascontiguousarray(mask), np.empty((height + 2 * reach, width + 2 * reach), np.uint8)
    job = ffi.new("grow_job *")
    job.mask, job.ways = ffi.from_buffer("uint8_t[]", cells), octets(ways)
    job.grown = ffi.from_buffer("uint8_t[]", grown, require_writable=True)
    job.rows, job.cols = mask.shape
    job.outside, job.reach, job.heights = outside, reach, octets(heights)
    job.first_row, job.end_row = window.first_row, window.end_row
    job.first_col, job.end_col = window.first_col, window.end_col
    lib.grow_disk(job)
