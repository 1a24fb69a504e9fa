"""Drawing beams on the grid, in C."""

from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.layout import SLOTS, Beams, BeamSettings
from robotd.grid.kernels.native.buffers import floats, ints


def draw_beams(readings: NDArray[np.float64], headings_rad: NDArray[np.float64], how: BeamSettings) -> Beams:
    """See the twin.

    Few beams are drawn in no time, so what they take is allocated at once, and nothing is done twice.
    """
    headings = len(headings_rad)
    count = len(readings) * headings
    bearings_rad = (readings[:, :1] + headings_rad).reshape(-1)
    ahead, turned = np.empty((2, count)), np.empty((3, headings))
    np.sin(bearings_rad, ahead[0])
    np.cos(bearings_rad, ahead[1])
    turned[0] = headings_rad
    np.sin(headings_rad, turned[1])
    np.cos(headings_rad, turned[2])
    table_size = 1 << max(1, (2 * count).bit_length())
    spare = np.empty(21 * count + table_size // 2, np.int64)
    job = ffi.new("draw_job *")
    job.readings, job.headings, job.ahead = floats(readings), floats(turned), floats(ahead)
    job.reading_count, job.heading_count, job.table_size = len(readings), headings, table_size
    job.resolution_m, job.reach_cells = how.resolution_m, how.reach_cells
    job.error_radius_cells, job.spare = how.error_radius_cells, ffi.from_buffer("int64_t[]", spare)
    lib.draw_groups(job)
    slots = max(SLOTS, 2 * job.longest) if count > SLOTS else max(count, 1)
    batches = min(job.group_count, 2 * count // slots + 1) + 1
    sizes = (3 * job.cell_count, job.group_count + 1, batches + 1, job.group_count, batches * headings + 1, 3 * count)
    out = np.empty(sum(sizes), np.int32)
    ends = list(accumulate(sizes, initial=0))
    to = ints(out)
    number = lib.draw_chains(job, slots, *(to + end for end in ends[:-1]))
    chains, groups, firsts, _, lists, beams = (out[begin:end] for begin, end in pairwise(ends))
    lists = lists[: number * headings + 1]
    return Beams(chains.reshape(-1, 3), groups, firsts[: number + 1], lists, beams.reshape(-1, 3), slots)
