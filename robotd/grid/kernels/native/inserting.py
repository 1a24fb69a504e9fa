"""A sweep into the occupancy grid, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.layout import Rays
from robotd.grid.kernels.native.buffers import floats, octets
from robotd.grid.ray import ray_steps, sample_counts
from robotd.grid.tables import UpdateTable


def insert_rays(
    cells: NDArray[np.uint8], rays: Rays, lower: UpdateTable, higher: UpdateTable, *, at_once: bool
) -> NDArray[np.intp]:
    """See the twin.

    Raises:
        ValueError: the cells are read-only.
    """
    rows, cols = cells.shape
    samples = sample_counts(rays.bearings_rad, rays.lengths_cells)
    beams = np.column_stack((rays.starts, ray_steps(rays.bearings_rad), samples))
    changed = np.empty(min(cells.size, int(np.minimum(samples, cells.size).sum()) + len(samples)), np.int64)
    number = lib.insert_beams(
        ffi.from_buffer("uint8_t[]", cells, require_writable=True),
        rows,
        cols,
        floats(beams),
        ffi.from_buffer("int64_t[]", rays.hits.astype(np.int64)),
        len(beams),
        octets(lower),
        octets(higher),
        at_once,
        octets(np.empty(cells.size, np.uint8)),
        ffi.from_buffer("int64_t[]", changed),
    )
    return changed[:number].astype(np.intp)
