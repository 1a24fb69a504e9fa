"""Cells packed into words, in NumPy: the twin of the kernel in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.shared.packed_map import PAD_WORDS, TILE_ROWS, WORD_CELLS, Words, pack
from robotd.grid.window import CellWindow


def pack_cells(words: Words, mask: NDArray[np.bool_], origin: tuple[int, int], window: CellWindow) -> None:
    """See :class:`.PackKernel`."""
    if window.is_empty:
        return
    # The corner is padding on every map, so it says what lies outside.
    outside = bool(words[0, 0])
    rows = slice(window.first_row, window.end_row)
    packed = pack(mask[rows], (0, origin[1]), outside=outside)
    top = TILE_ROWS + origin[0] + window.first_row
    first = PAD_WORDS + (origin[1] + window.first_col) // WORD_CELLS
    end = PAD_WORDS + (origin[1] + window.end_col - 1) // WORD_CELLS + 1
    height = window.shape[0]
    words[first:end, top : top + height] = packed[first:end, TILE_ROWS : TILE_ROWS + height]
