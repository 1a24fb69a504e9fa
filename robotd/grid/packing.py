"""A packed map after a change: only the words and tiles that the change can have touched are made anew."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robotd.grid import kernels
from robotd.grid.kernels.layout import PackedMap, planes_of, tiles_of
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
    planes = packed.planes[:3].copy()
    for words, mask in zip(planes, (free, blocking, grown), strict=True):
        kernels.pack_cells(words, mask, packed.origin, changed)
    return replace(packed, planes=planes_of(*planes), tiles=tiles_of(planes[0]))
