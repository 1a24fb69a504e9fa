"""What the fitting of poses to walls works on: how far the nearest wall is, and how far a beam may be sure to go.

Distances are kept as one signed byte a cell: the square of the distance between cell centres, which is a whole number.
Cells that are no wall hold the square to the nearest wall, up to ``REACH_CELLS`` of it, walls the square to the nearest
cell that is none, negative, up to ``DEPTH_CELLS``. A table of 256 entries turns a byte into a distance, and so says
where in its cells a wall lies, without the field being made anew. Both are exact, and as no cell knows of anything
farther away, what changes in a window changes the field no farther round it.
"""

from dataclasses import dataclass

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
"""Skips of a cell that ends a beam as a wall does, and of one that stops it as nobody knows what is there."""

HEADS_MIN = 3
"""With fewer heads than unknowns nothing can be fitted."""
LAGS = 8
"""Over how many neighbours heads are taken to err together, at most."""
LEAST_SPREAD_CELLS = 0.1
"""Heads are not believed to fit better than this."""
UNKNOWN_CELLS, UNKNOWN_RAD = 256.0, 3.141592653589793
"""Standard deviations of what the readings say nothing of."""


@dataclass(frozen=True, slots=True, eq=False)
class Fits:
    """Poses fitted to walls, one for each box; lengths in cells."""

    poses: NDArray[np.float64]
    """``float64[n, 3]``: x, y, heading."""
    covariances: NDArray[np.float64]
    """``float64[n, 3, 3]``."""
    quality: NDArray[np.float64]
    """``float64[n, 3]``: sum of the heads' weights, weighted mean of their squared distances, and how much the variance
    is greater than if neighbours erred independently."""
    beyond: NDArray[np.float64]
    """``float64[n, heads]``: how far each head lies beyond its wall, negative short of it."""


@dataclass(frozen=True, slots=True, eq=False)
class Lattice:
    """Poses at even steps round a start."""

    start: NDArray[np.float64]
    """``float64[3]``: x, y [cells], heading [rad]."""
    steps: NDArray[np.int32]
    """``int32[6]``: first and last number of steps along x, y and heading; none is empty."""
    step_cells: int
    step_rad: float

    @property
    def shape(self) -> tuple[int, int]:
        """How many places there are along y and along x."""
        x_first, x_last, y_first, y_last = self.steps[:4].tolist()
        return y_last - y_first + 1, x_last - x_first + 1
