"""A packed map after a change: only the words and tiles that the change can have touched are made anew."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robotd.grid import kernels
from robotd.grid.kernels.layout import PackedMap, Words, any_of_a_tile, tiles_of
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

    def anew(words: Words, mask: NDArray[np.bool_]) -> Words:
        copied = words.copy()
        kernels.pack_cells(copied, mask, packed.origin, changed)
        return copied

    cells, stops, ends = anew(packed.free, free), anew(packed.blocking, blocking), anew(packed.grown, grown)
    return replace(
        packed,
        free=cells,
        blocking=stops,
        grown=ends,
        stopping=any_of_a_tile(stops),
        ending=any_of_a_tile(ends),
        tiles=tiles_of(cells),
    )
