"""Cells packed into words, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.shared.library import ffi, lib, octets
from robotd.grid.kernels.shared.packed_map import PAD_WORDS, TILE_ROWS, WORD_CELLS, Words
from robotd.grid.window import CellWindow


def pack_cells(words: Words, mask: NDArray[np.bool_], origin: tuple[int, int], window: CellWindow) -> None:
    """See :class:`.PackKernel`.

    Raises:
        ValueError: the words are read-only.
    """
    if window.is_empty:
        return
    bounds = (window.first_row, window.end_row, window.first_col, window.end_col)
    top, left = TILE_ROWS + origin[0], PAD_WORDS * WORD_CELLS + origin[1]
    whole = ffi.from_buffer("uint64_t[]", words, require_writable=True)
    # A copy only if the mask is a view; C walks rows by their width.
    cells = octets(np.ascontiguousarray(mask).view(np.uint8))
    lib.pack_cells(cells, mask.shape[1], bounds, top, left, words.shape[1], whole)
