"""Packing cells into words: what the kernel does."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.shared.packed_map import Words
from robotd.grid.window import CellWindow


class PackKernel(Protocol):
    """Packing cells into words."""

    def pack_cells(self, words: Words, mask: NDArray[np.bool_], origin: tuple[int, int], window: CellWindow) -> None:
        """Pack the cells of a window again; cells that share a word with them, too.

        Args:
            words: ``uint64[words + 4, rows + padding]``, from
                :func:`~robotd.grid.kernels.shared.packed_map.pack` of such a mask and the same origin, changed in
                place.
            mask: ``bool[rows, cols]``.
            origin: row and column, within the first tile, where the mask begins.
            window: which cells.
        """
