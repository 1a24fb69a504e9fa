"""A map of chances: cells neither stop beams nor let them through, but do so with a chance that evidence gives."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

UNKNOWN = 128
"""The value of a cell that nobody has seen; those of vacant cells are less, those of obstacles greater."""

AS_MAPPED = 0
"""A weighed beam ends at an obstacle of the map; a miss: nowhere before its range."""
IN_UNKNOWN = 1
"""It ends where nobody has looked."""
IN_VACANT = 2
"""It ends in a cell that is vacant on the map."""


@dataclass(frozen=True, slots=True, eq=False)
class ChanceMap:
    """What :func:`~robotd.grid.kernels.weigh_beams` needs of a map; all arrays are contiguous."""

    cells: NDArray[np.uint8]
    """``uint8[rows, cols]``, the evidence of the occupancy grid; what lies outside was never seen."""
    skips: NDArray[np.uint8]
    """``uint8[rows, cols]``: how many steps, over sides or corners, it is from a vacant cell to the nearest that is
    not, and from an unknown one likewise, up to ``SKIP_MAX``: nearer cells need no look. 1 for obstacles."""
    stops: NDArray[np.float64]
    """``float64[256]``: the chance of an obstacle of this value to stop a beam, below 1; of an unknown cell the chance
    for each cell's length of way; of a vacant one the density [1 / cell] of what stands there and is not mapped."""
