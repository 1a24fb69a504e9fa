"""The smallest error radius of every cell, in NumPy: the twin of the kernel in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.draw.draw_kernel import NO_HEAD
from robotd.grid.kernels.error_radius.error_radius_kernel import Bodies
from robotd.grid.kernels.shared.packed_counting import seen_from
from robotd.grid.kernels.shared.packed_map import PAD_WORDS, TILE_ROWS, PackedMap, unpack
from robotd.grid.translation import translated

_NEVER = int(np.iinfo(np.uint16).max)


def share_errors(
    the_map: PackedMap,
    distances: NDArray[np.uint16],
    outside: int,
    bodies: Bodies,
    wanted: int,
    *,
    threads: int = 1,  # noqa: ARG001  # one thread is all that this needs
) -> NDArray[np.uint16]:
    """See :class:`.ErrorRadiusKernel`."""
    free = _cells(the_map, the_map.free[PAD_WORDS:-PAD_WORDS, TILE_ROWS:-TILE_ROWS])
    needed = np.empty((len(bodies.readings), np.count_nonzero(free)), np.uint16)
    for number, (first, end, row, col) in enumerate(bodies.readings.tolist()):
        body = _needed_by_body(the_map, free, bodies, range(first, end))
        ends = np.zeros_like(distances) if row == NO_HEAD else translated(distances, row, col, outside=outside)
        needed[number] = np.maximum(body, ends)[free]
    errors = np.full(the_map.shape, _NEVER, np.uint16)
    errors[free] = np.partition(needed, wanted - 1, axis=0)[wanted - 1]
    return errors


def _needed_by_body(the_map: PackedMap, free: NDArray[np.bool_], bodies: Bodies, cells: range) -> NDArray[np.uint16]:
    needed = np.zeros(the_map.shape, np.uint16)
    # Where one cell is enough to block, it is as if one had been met before.
    still_open, met = free.copy(), np.full_like(free, the_map.blocked_by == 1)
    for cell in cells:
        row, col = bodies.chains[cell].tolist()
        blocking = _cells(the_map, seen_from(the_map.blocking, row, col))
        stopped = still_open & met & blocking
        met |= blocking
        needed[stopped] = bodies.lengths[cell]
        still_open &= ~stopped
    return needed


def _cells(the_map: PackedMap, words: NDArray[np.uint64]) -> NDArray[np.bool_]:
    """Return ``bool[rows, cols]`` of the map from words ``uint64[words, rows]``."""
    (top, left), (rows, cols) = the_map.origin, the_map.shape
    return unpack(words.T[top : top + rows], left + cols)[:, left:]
