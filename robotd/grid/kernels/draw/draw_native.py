"""Drawing beams on the grid, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.draw.draw_kernel import SLOTS, Beams, BeamSettings
from robotd.grid.kernels.shared.buffers import floats, ints, longs


def draw_beams(readings: NDArray[np.float64], headings: NDArray[np.float64], how: BeamSettings) -> Beams:
    """See :class:`.DrawKernel`.

    Few beams are drawn in no time, so what they take is allocated at once, and nothing is done twice.
    """
    reading_count, heading_count = len(readings), headings.shape[1]
    count = reading_count * heading_count
    table_size = 1 << max(1, (2 * count).bit_length())
    ahead, spare = np.empty((3, count)), np.empty(22 * count + table_size // 2, np.int64)
    job = ffi.new("draw_job *")
    job.readings, job.headings, job.ahead = floats(readings), floats(headings), floats(ahead)
    job.reading_count, job.heading_count = reading_count, heading_count
    job.table_size, job.slots, job.spare = table_size, SLOTS, longs(spare)
    job.resolution_m, job.reach_cells = how.resolution_m, how.reach_cells
    job.error_radius_cells = how.error_radius_cells
    lib.find_bearings(job)
    np.sin(ahead[0], ahead[1])
    np.cos(ahead[0], ahead[2])
    numbers = np.empty(lib.draw_groups(job), np.int32)
    lib.draw_chains(job, ints(numbers))
    return Beams(numbers)
