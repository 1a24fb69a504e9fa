"""The distance transform, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.distance.distance_kernel import NOWHERE
from robotd.grid.kernels.shared.library import agree, ffi, ints, lib
from robotd.grid.window import CellWindow

agree(NOWHERE=NOWHERE)


def squared_distances(
    sources: NDArray[np.bool_], squares: NDArray[np.int32], window: CellWindow, *, limit_cells: int, outside: bool
) -> None:
    """See :class:`.DistanceKernel`.

    Raises:
        ValueError: the squares are read-only.
    """
    if window.is_empty:
        return
    rows, cols = sources.shape
    cells = np.ascontiguousarray(sources)
    along, spare = np.empty((window.shape[0], cols), np.int32), np.empty(3 * (cols + 2), np.int32)
    job = ffi.new("distance_job *")
    job.sources = ffi.from_buffer("uint8_t[]", cells)
    # C would write into read-only memory without a word.
    job.squares = ffi.from_buffer("int32_t[]", squares, require_writable=True)
    job.rows, job.cols, job.outside, job.limit = rows, cols, outside, min(limit_cells, rows + cols)
    job.first_row, job.end_row = window.first_row, window.end_row
    job.first_col, job.end_col = window.first_col, window.end_col
    job.along, job.spare = ints(along), ints(spare)
    lib.squared_distances(job)
