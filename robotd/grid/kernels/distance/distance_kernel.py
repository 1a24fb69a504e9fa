"""Squared distances, and what stands for none."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robotd.grid.window import CellWindow

NOWHERE = int(np.iinfo(np.int32).max)
"""The squared distance to a source that is farther than anybody looked."""


class DistanceKernel(Protocol):
    """The exact Euclidean distance transform, squared, in whole numbers."""

    def squared_distances(
        self,
        sources: NDArray[np.bool_],
        squares: NDArray[np.int32],
        window: CellWindow,
        *,
        limit_cells: int,
        outside: bool,
    ) -> None:
        """Work out how far it is from each cell of a window to the nearest source.

        Args:
            sources: ``bool[rows, cols]``.
            squares: ``int32[rows, cols]``, changed in the window: the squares of the distances in cells, ``NOWHERE`` if
                no source is within the limit.
            window: which cells.
            limit_cells: how far to look.
            outside: whether what lies beyond the grid is a source.

        O(cells x greatest distance); the kernel in C is O(cells). The cells are those of the window and those within
        the limit of it.
        """
