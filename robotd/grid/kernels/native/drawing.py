"""Drawing beams on the grid, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.layout import SLOTS, Beams, BeamSettings
from robotd.grid.kernels.native.buffers import floats, ints


def draw_beams(readings: NDArray[np.float64], headings_rad: NDArray[np.float64], how: BeamSettings) -> Beams:
    """See the twin.

    Few beams are drawn in no time, so what they take is allocated at once, and nothing is done twice.
    """
    headings, count = len(headings_rad), len(readings) * len(headings_rad)
    ahead, turned = np.empty((2, len(readings), headings)), np.empty((2, headings))
    bearings_rad = readings[:, :1] + headings_rad
    np.sin(bearings_rad, ahead[0])
    np.cos(bearings_rad, ahead[1])
    np.sin(headings_rad, turned[0])
    np.cos(headings_rad, turned[1])
    table_size = 1 << max(1, (2 * count).bit_length())
    spare = np.empty(22 * count + table_size // 2, np.int64)
    job = ffi.new("draw_job *")
    job.readings, job.headings = floats(readings), floats(headings_rad)
    job.turned, job.ahead = floats(turned), floats(ahead)
    job.reading_count, job.heading_count, job.table_size, job.slots = len(readings), headings, table_size, SLOTS
    job.resolution_m, job.reach_cells = how.resolution_m, how.reach_cells
    job.error_radius_cells, job.spare = how.error_radius_cells, ffi.from_buffer("int64_t[]", spare)
    numbers = np.empty(lib.draw_groups(job), np.int32)
    lib.draw_chains(job, ints(numbers))
    return Beams(numbers)
