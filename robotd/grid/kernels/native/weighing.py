"""Beams on a map of chances, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import lib
from robotd.grid.kernels.native.buffers import floats, octets


def weigh_beams(
    cells: NDArray[np.uint8], stops: NDArray[np.float64], poses: NDArray[np.float64], beams: NDArray[np.float64]
) -> NDArray[np.float64]:
    """See the twin."""
    chances = np.empty((len(poses), len(beams), 3))
    if chances.size:
        rows, cols = cells.shape
        lib.weigh_beams(
            octets(cells),
            rows,
            cols,
            floats(np.ascontiguousarray(stops)),
            floats(np.ascontiguousarray(poses)),
            len(poses),
            floats(np.ascontiguousarray(beams)),
            len(beams),
            floats(chances),
        )
    return chances
