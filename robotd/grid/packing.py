"""A packed map after a change: only the words and tiles that the change can have touched are made again."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robotd.grid import kernels
from robotd.grid.kernels.shared.packed_map import PAD_WORDS, TILE_ROWS, WORD_CELLS, PackedMap, any_of_a_tile, tiles_of
from robotd.grid.window import CellWindow


def repacked(
    packed: PackedMap,
    free: NDArray[np.bool_],
    blocking: NDArray[np.bool_],
    grown: NDArray[np.bool_],
    changed: CellWindow,
) -> PackedMap:
    """Return the packed map of three masks that differ from those of another one in a window alone.

    It has the origin of the other one, so what is counted does not depend on how the map came to be.

    Args:
        packed: of the masks as they were; not changed.
        free: ``bool[rows, cols]``, as they are.
        blocking: the same.
        grown: the same.
        changed: holds all cells in which any of them differs.
    """
    if changed.is_empty:
        return packed
    planes = packed.planes.copy()
    # The first three planes are the masks; the two after them are pooled from these below.
    for words, mask in zip(planes, (free, blocking, grown), strict=False):
        kernels.in_use().pack.pack_cells(words, mask, packed.origin, changed)
    top, left = TILE_ROWS + packed.origin[0], PAD_WORDS * WORD_CELLS + packed.origin[1]
    first, end = top + changed.first_row, top + changed.end_row
    columns = slice((left + changed.first_col) // WORD_CELLS, (left + changed.end_col - 1) // WORD_CELLS + 1)
    above = first - TILE_ROWS + 1  # the first row from which a tile reaches down to a changed one
    planes[3:, columns, above:end] = any_of_a_tile(planes[1:3, columns, above : end + TILE_ROWS - 1])
    return replace(packed, planes=planes, tiles=tiles_of(planes[0]))
