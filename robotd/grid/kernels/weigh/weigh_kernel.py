"""A map of chances: cells neither stop beams nor let them through, but do so with a chance that evidence gives."""

from dataclasses import dataclass
from typing import Protocol

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
    """What :meth:`.WeighKernel.weigh_beams` needs of a map; all arrays are contiguous."""

    cells: NDArray[np.uint8]
    """``uint8[rows, cols]``, the evidence of the occupancy grid; what lies outside was never seen."""
    skips: NDArray[np.uint8]
    """``uint8[rows, cols]``: how many steps, over sides or corners, it is from a vacant cell to the nearest that is
    not, and from an unknown one likewise, up to ``SKIP_MAX``: nearer cells need no look. 1 for obstacles."""
    stops: NDArray[np.float64]
    """``float64[256]``: the chance of an obstacle of this value to stop a beam, below 1; of an unknown cell the chance
    for each cell's length of way; of a vacant one the density [1 / cell] of what stands there and is not mapped."""


class WeighKernel(Protocol):
    """Weighing beams on a map of chances."""

    def weigh_beams(
        self, the_map: ChanceMap, poses: NDArray[np.float64], beams: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return how likely each beam ended where it did, seen from each pose.

        A beam that is followed through the map is thinned cell by cell, and what is taken from it in a cell is the
        chance that it ends there; only what is not on the map takes nothing from it. It is sampled as in
        :mod:`robotd.grid.ray`. Where it meets an obstacle is blurred by Student's t with three degrees of freedom along
        the beam, and across it by three parallel rays, which have its variance. Obstacle cells side by side are one
        obstacle, as likely to be there as the likeliest of them.

        Args:
            the_map: the map.
            poses: ``float64[n, 4]``: row, column, cosine and sine of the heading, in cells.
            beams: ``float64[m, 8]``: x and y of the start in the robot frame, cosine and sine of the bearing, the
                range, its standard deviation along and across the beam, all in cells, and 1 for a miss, 0 for a hit.

        Returns:
            ``float64[n, m, 3]``: for a hit the density [1 / cell] of its range by where it ends; for a miss the
            chance that nothing stops it, and two zeros. O(n m obstacles and unknown cells on the way).
        """
