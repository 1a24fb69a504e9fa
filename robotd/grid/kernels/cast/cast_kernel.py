"""How far the nearest wall is, and how far a beam may be sure to go: two codes of a byte a cell.

Distances are kept as one signed byte a cell: the square of the distance between cell centres, which is a whole number.
Cells that are no wall hold the square to the nearest wall, up to ``REACH_CELLS`` of it, walls the square to the nearest
cell that is none, negative, up to ``DEPTH_CELLS``. A table of 256 entries turns a byte into a distance, and so says
where in its cells a wall lies, without the field being made again. Both are exact, and as no cell knows of anything
farther away, what changes in a window changes the field no farther round it.
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

REACH_CELLS = 8
"""Farther than this from a wall all is equally far."""
FAR_CODE = REACH_CELLS * REACH_CELLS
DEPTH_CELLS = 4
"""Deeper than this in a wall all is equally deep."""
SKIP_MAX = 15
"""No beam skips more cells than this at once."""
ENDS, BLOCKS = 0, 255
"""Skips of a cell that ends a beam as a wall does, and of one that stops it as what is there is unknown."""


class CastKernel(Protocol):
    """Wall fields, and beams cast on them."""

    def wall_codes(self, walls: NDArray[np.bool_]) -> NDArray[np.int8]:
        """Return the squared distances of a map ``bool[rows, cols]``, ``int8[rows, cols]``; nothing lies outside it."""

    def skip_codes(self, ends: NDArray[np.bool_], blocks: NDArray[np.bool_]) -> NDArray[np.uint8]:
        """Return how far beams may skip, ``uint8[rows + 2, cols + 2]``, with a ring of ``BLOCKS`` round the map.

        A cell in which nothing stops a beam holds how many steps, over sides or corners, it is to the nearest that
        does, up to ``SKIP_MAX``: so far round it there is nothing.

        Args:
            ends: ``bool[rows, cols]``, walls.
            blocks: ``bool[rows, cols]``, other cells that stop a beam.
        """

    def cast_beams(
        self, skips: NDArray[np.uint8], beams: NDArray[np.float64], poses: NDArray[np.float64], blocked_by: int
    ) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
        """Return how far beams go from each pose, exactly, and what stops them.

        Args:
            skips: ``uint8[rows + 2, cols + 2]``.
            beams: ``float64[m, 4]``: where each starts, ``(x, y)`` [cells], and the cosine and sine of its bearing, in
                the robot frame.
            poses: ``float64[n, 4]``: x, y [cells], cosine and sine of the heading.
            blocked_by: how many cells a beam must meet to be stopped; where the run of cells began in which it met the
                last one is how far it goes.

        Returns:
            ``float64[n, m]`` [cells], 0 for a beam that starts in a cell that stops it, and ``uint8[n, m]``, ``ENDS``
            or ``BLOCKS``. Beams from outside the grid go nowhere, those that leave it end at its edge.

        O(n m way / free space round it).
        """
