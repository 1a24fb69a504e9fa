"""Drawing beams on the grid, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.layout import SLOTS, Beams, BeamSettings
from robotd.grid.kernels.native.buffers import floats, ints


def draw_beams(readings: NDArray[np.float64], headings_rad: NDArray[np.float64], how: BeamSettings) -> Beams:
    """See the twin."""
    count = len(readings) * len(headings_rad)
    bearings_rad = (readings[:, :1] + headings_rad).ravel()
    ahead = np.stack((np.sin(bearings_rad), np.cos(bearings_rad)), axis=1)
    turned = np.stack((headings_rad, np.sin(headings_rad), np.cos(headings_rad)), axis=1)
    table = np.empty(1 << (2 * count).bit_length(), np.int32)
    keys, steps = np.empty((2 * count, 5), np.int64), np.empty((2 * count, 4))
    sizes, drawn = np.empty(2 * count, np.int32), np.empty((count, 4), np.int32)
    job = ffi.new("draw_job *")
    job.readings, job.headings, job.ahead = floats(readings), floats(turned), floats(ahead)
    job.reading_count, job.heading_count = len(readings), len(headings_rad)
    job.resolution_m, job.error_radius_cells, job.reach_cells = (
        how.resolution_m,
        how.error_radius_cells,
        how.reach_cells,
    )
    job.table, job.table_size, job.drawn = ints(table), len(table), ints(drawn)
    job.keys, job.steps, job.sizes = ffi.from_buffer("int64_t[]", keys), floats(steps), ints(sizes)
    groups = lib.draw_groups(job)
    cells, longest = int(sizes[:groups].sum()), int(sizes[:groups].max(initial=1))
    slots = max(SLOTS, 2 * longest) if count > SLOTS else max(count, 1)
    batches_max = min(groups, 2 * count // slots + 1) + 1
    chains, ends = np.empty((cells, 3), np.int32), np.empty(groups + 1, np.int32)
    batches, batch_of = np.empty(batches_max + 1, np.int32), np.empty(groups, np.int32)
    lists = np.empty(batches_max * len(headings_rad) + 1, np.int32)
    beams = np.empty((count, 3), np.int32)
    out = (ints(array) for array in (chains, ends, batches, batch_of, lists, beams))
    number = lib.draw_chains(job, groups, slots, *out)
    return Beams(chains, ends, batches[: number + 1], lists[: number * len(headings_rad) + 1], beams, slots)
