"""Drawing beams on the grid, in C."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotd.grid.drawn import FAR_CELLS
from robotd.grid.kernels.draw.draw_kernel import NO_HEAD, SLOTS, Beams, BeamSettings
from robotd.grid.kernels.shared.library import agree, ffi, floats, ints, lib, words

agree(FAR_CELLS=FAR_CELLS, NO_HEAD=NO_HEAD)


def draw_beams(readings: NDArray[np.float64], headings: NDArray[np.float64], how: BeamSettings) -> Beams:
    """See :class:`.DrawKernel`.

    Few beams are drawn in no time, so what they take is allocated at once, and nothing is done twice.
    """
    reading_count, heading_count = len(readings), headings.shape[1]
    count = reading_count * heading_count
    ahead = np.empty((3, count))
    job = ffi.new("draw_job *")
    job.readings, job.headings, job.ahead = floats(readings), floats(headings), floats(ahead)
    job.reading_count, job.heading_count = reading_count, heading_count
    job.slots = SLOTS
    job.resolution_m, job.reach_cells = how.resolution_m, how.reach_cells
    job.error_radius_cells = how.error_radius_cells
    scratch = words(np.empty(lib.draw_scratch_words(job), np.uint64))
    job.scratch = scratch
    lib.find_bearings(job)
    # NumPy's sines, not the C library's, which differ in the last place: chains have to be the twin's.
    np.sin(ahead[0], ahead[1])
    np.cos(ahead[0], ahead[2])
    numbers, drawn = np.empty(lib.draw_groups(job), np.int32), ffi.new("drawn_beams *")
    lib.draw_chains(job, ints(numbers), drawn)
    return Beams(numbers, drawn)


def drawn_of(beams: Beams) -> Any:
    """Return the C struct of beams, ``drawn_beams``, no matter who drew them; it does not keep the arrays alive."""
    if isinstance(beams.drawn, ffi.CData):
        return beams.drawn[0]
    found, sizes = ffi.new("drawn_beams *"), beams.drawn
    found.cell_count, found.group_count, found.beam_count = sizes.cell_count, sizes.group_count, sizes.beam_count
    found.batch_count, found.heading_count, found.slots = sizes.batch_count, sizes.heading_count, sizes.slots
    found.chains, found.groups, found.beams = ints(beams.chains), ints(beams.groups), ints(beams.beams)
    found.batches, found.lists = ints(beams.batches), ints(beams.lists)
    return found[0]
