"""Poses fitted to walls, by the codes of :mod:`robotd.grid.kernels.cast.cast_kernel`."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
