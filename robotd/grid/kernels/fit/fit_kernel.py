"""Poses fitted to walls, by the codes of :mod:`robotd.grid.kernels.cast.cast_kernel`."""

from dataclasses import dataclass
from typing import Protocol

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


class FitKernel(Protocol):
    """Fitting poses to walls."""

    def fit_poses(
        self,
        codes: NDArray[np.int8],
        distances: NDArray[np.float64],
        heads: NDArray[np.float64],
        boxes: NDArray[np.float64],
        outlier_cells: float,
    ) -> Fits:
        """Move poses within their boxes so that the heads of the readings come to lie on walls.

        Gauss and Newton's steps on the distance field, interpolated between cell centres, with Tukey's biweight, whose
        width narrows to ``outlier_cells``. A box binds by its active sides; in it the start is believed a little, so
        that what the readings do not tell stays where it was.

        Args:
            codes: ``int8[rows, cols]``, squared distances.
            distances: ``float64[256]``, the distance [cells] that each code stands for, by ``code + 128``.
            heads: ``float64[m, 2]``, ``(x, y)`` in the robot frame [cells].
            boxes: ``float64[n, 9]``: start x, y [cells], heading [rad]; the least they may become; the greatest.
            outlier_cells: a head so far from any wall has no say.

        O(n m) a step, at most 32 steps.
        """

    def scan_poses(
        self, codes: NDArray[np.int8], costs: NDArray[np.int32], heads: NDArray[np.float64], lattice: Lattice
    ) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Return, for each place of a lattice, what the heads cost at its best heading, and which that is.

        Args:
            codes: ``int8[rows, cols]``, squared distances.
            costs: ``int32[256]``, what a head costs in a cell, by ``code + 128``; outside the map as far from any wall.
            heads: ``float64[m, 2]``, ``(x, y)`` in the robot frame [cells].
            lattice: the poses.

        Returns:
            Both ``int32[places along y, places along x]``; the heading as its number of steps, the first of equal ones.

        O(poses m).
        """
