"""The smallest error radius of every cell, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.draw.draw_kernel import NO_HEAD
from robotd.grid.kernels.error_radius.error_radius_kernel import Bodies
from robotd.grid.kernels.shared.library import agree, ffi, ints, lib, put_map, shorts
from robotd.grid.kernels.shared.packed_map import TILE_ROWS, WORD_CELLS, PackedMap

agree(NO_HEAD=NO_HEAD)


def share_errors(
    the_map: PackedMap, distances: NDArray[np.uint16], outside: int, bodies: Bodies, wanted: int, *, threads: int = 1
) -> NDArray[np.uint16]:
    """See :class:`.ErrorRadiusKernel`."""
    rows, cols = the_map.shape
    errors = np.full(the_map.shape, np.iinfo(np.uint16).max, np.uint16)
    # No more than there are tiles, for each thread takes its own scratch.
    threads = min(threads, lib.THREADS_MAX, max(1, len(the_map.tiles)))
    needed = np.empty((threads, len(bodies.readings), TILE_ROWS * WORD_CELLS), np.uint16)
    job = ffi.new("errors_job *")
    put_map(job.map, the_map)
    (job.origin_row, job.origin_col), job.map_rows, job.map_cols = the_map.origin, rows, cols
    job.distances, job.outside = shorts(distances), outside
    job.chains, job.lengths = ints(bodies.chains), shorts(bodies.lengths)
    job.readings, job.reading_count, job.wanted = ints(bodies.readings), len(bodies.readings), wanted
    job.needed, job.errors = shorts(needed), shorts(errors)
    job.threads = threads
    lib.share_errors(job)
    return errors
