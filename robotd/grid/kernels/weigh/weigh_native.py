"""Beams on a map of chances, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.shared.library import agree, floats, lib, octets
from robotd.grid.kernels.weigh.weigh_kernel import AS_MAPPED, IN_UNKNOWN, IN_VACANT, UNKNOWN, ChanceMap

agree(AS_MAPPED=AS_MAPPED, IN_UNKNOWN=IN_UNKNOWN, IN_VACANT=IN_VACANT, UNKNOWN=UNKNOWN)


def weigh_beams(the_map: ChanceMap, poses: NDArray[np.float64], beams: NDArray[np.float64]) -> NDArray[np.float64]:
    """See :class:`.WeighKernel`."""
    chances = np.empty((len(poses), len(beams), 3))
    if chances.size:
        rows, cols = the_map.cells.shape
        lib.weigh_beams(
            octets(the_map.cells),
            octets(the_map.skips),
            rows,
            cols,
            floats(the_map.stops),
            floats(np.ascontiguousarray(poses)),
            len(poses),
            floats(np.ascontiguousarray(beams)),
            len(beams),
            floats(chances),
        )
    return chances
