"""Growing by a disk: what the kernel does."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robotd.grid.window import CellWindow


class GrowKernel(Protocol):
    """Growing sets of cells by a disk: the Minkowski sum with B_eps."""

    def grow_disk(
        self,
        mask: NDArray[np.bool_],
        grown: NDArray[np.bool_],
        window: CellWindow,
        *,
        radius_cells: float,
        outside: bool,
    ) -> None:
        """Work out which cells of a window have a cell of a set within a radius.

        Args:
            mask: ``bool[rows, cols]``, the set.
            grown: ``bool[rows, cols]``, changed in the window.
            window: which cells.
            radius_cells: at least 0; the kernel in C takes less than 255.
            outside: whether what lies beyond the grid is in the set.

        O(cells x radius): the cells are those of the window and those within the radius of it.
        """
