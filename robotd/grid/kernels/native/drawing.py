"""Drawing beams on the grid, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.layout import SLOTS, Beams, BeamSettings
from robotd.grid.kernels.native.buffers import floats, ints, longs


def draw_beams(readings: NDArray[np.float64], headings: NDArray[np.float64], how: BeamSettings) -> Beams:
    """See the twin.

    Few beams are drawn in no time, so what they take is allocated at once, and nothing is done twice.
    """
    bearings_rad = readings[:, :1] + headings[0]
    ahead, count = np.empty((2, *bearings_rad.shape)), bearings_rad.size
    np.sin(bearings_rad, ahead[0])
    np.cos(bearings_rad, ahead[1])
    table_size = 1 << max(1, (2 * count).bit_length())
    spare = np.empty(22 * count + table_size // 2, np.int64)
    job = ffi.new("draw_job *")
    job.readings, job.headings, job.ahead = floats(readings), floats(headings), floats(ahead)
    job.reading_count, job.heading_count = bearings_rad.shape
    job.table_size, job.slots, job.spare = table_size, SLOTS, longs(spare)
    job.resolution_m, job.reach_cells = how.resolution_m, how.reach_cells
    job.error_radius_cells = how.error_radius_cells
    numbers = np.empty(lib.draw_groups(job), np.int32)
    lib.draw_chains(job, ints(numbers))
    return Beams(numbers)
