"""Counting feasible poses, in NumPy: the twin of the kernel in C."""

import itertools

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.draw.draw_kernel import NO_HEAD, Beams
from robotd.grid.kernels.shared.packed_counting import ripple, seen_from, tiles_of_plane
from robotd.grid.kernels.shared.packed_map import TILE_ROWS, PackedMap, Words, unpack


def count_feasible(
    counters: Words,
    the_map: PackedMap,
    beams: Beams,
    *,
    subtract: bool = False,
    threads: int = 1,  # noqa: ARG001  # one thread is all that this needs
) -> None:
    """See :class:`.CountKernel`."""
    headings = counters.shape[1]
    for batch in range(len(beams.batches) - 1):
        kept = _walk(the_map, beams, range(*beams.batches[batch : batch + 2].tolist()))
        bounds = beams.lists[batch * headings : (batch + 1) * headings + 1].tolist()
        for heading, (first, last) in enumerate(itertools.pairwise(bounds)):
            for slot, row, col in beams.beams[first:last].tolist():
                feasible = kept[slot] if row == NO_HEAD else kept[slot] & seen_from(the_map.grown, row, col)
                ripple(counters[:, heading], tiles_of_plane(feasible, the_map), subtract=subtract)


def _walk(the_map: PackedMap, beams: Beams, groups: range) -> dict[int, Words]:
    """Return by slot the free cells that the bodies of a batch do not block, ``uint64[words, rows]``."""
    kept = {}
    for group in groups:
        still_open = seen_from(the_map.free, 0, 0).copy()
        # Where one cell is enough to block, it is as if one had been met before.
        met = np.full_like(still_open, ~np.uint64(0) if the_map.blocked_by == 1 else 0)
        for row, col, slot in beams.chains[beams.groups[group] : beams.groups[group + 1]].tolist():
            blocking = seen_from(the_map.blocking, row, col)
            still_open &= ~(met & blocking)
            met |= blocking
            if slot >= 0:
                kept[slot] = still_open.copy()
    return kept


def greatest(counters: Words) -> int:
    """See :class:`.CountKernel`."""
    best, value = np.full_like(counters[:, :, 0], ~np.uint64(0)), 0
    for bit in reversed(range(counters.shape[2])):
        # From the highest digit down: a count that lacks one which another has is out, whatever follows.
        better = best & counters[:, :, bit]
        if better.any():
            best, value = better, value | 1 << bit
    return value


def at_least(counters: Words, the_map: PackedMap, least: int) -> Words:
    """See :class:`.CountKernel`."""
    _, headings, bits, _ = counters.shape
    masks = np.zeros((headings, the_map.rows, the_map.words), np.uint64)
    # More than the counters hold: no count reaches it, and the digits below would be compared alone.
    if least >> bits:
        return masks
    greater, equal = np.zeros_like(counters[:, :, 0]), np.full_like(counters[:, :, 0], ~np.uint64(0))
    for bit in reversed(range(bits)):
        if least >> bit & 1:
            equal &= counters[:, :, bit]
        else:
            greater |= equal & counters[:, :, bit]
            equal &= ~counters[:, :, bit]
    by_block = masks.reshape(headings, -1, TILE_ROWS, the_map.words)
    by_block[:, the_map.tiles[:, 1] // TILE_ROWS, :, the_map.tiles[:, 0]] = greater | equal
    return masks


def heat(
    counters: Words,
    the_map: PackedMap,
    first: tuple[int, int],
    shape: tuple[int, int],
    *,
    readings: int,
    block: int,
) -> NDArray[np.uint8]:
    """See :class:`.CountKernel`."""
    (rows, cols), (top, left) = shape, first
    # Rows and columns until whole blocks are there.
    counts = np.zeros((-(-rows // block) * block, -(-cols // block) * block), np.uint32)
    tiled = np.zeros((the_map.rows // TILE_ROWS, TILE_ROWS, the_map.words), np.uint64)
    best = np.zeros_like(counters[:, 0])
    for heading in range(counters.shape[1]):
        best = _greater(best, counters[:, heading])
    for bit in range(counters.shape[2]):
        tiled[the_map.tiles[:, 1] // TILE_ROWS, :, the_map.tiles[:, 0]] = best[:, bit]
        cells = unpack(tiled.reshape(the_map.rows, -1)[top : top + rows], left + cols)[:, left:]
        counts[:rows, :cols] |= cells.astype(np.uint32) << np.uint32(bit)
    blocks = counts.reshape(counts.shape[0] // block, block, -1, block).max(axis=(1, 3))
    levels: NDArray[np.uint8] = (blocks * np.uint32(255) // np.uint32(readings)).astype(np.uint8)
    return levels


def _greater(one: Words, other: Words) -> Words:
    """Return the greater of two counts of each cell, ``uint64[tiles, bits, 32]``."""
    greater, equal = np.zeros_like(one[:, 0]), np.full_like(one[:, 0], ~np.uint64(0))
    for bit in reversed(range(one.shape[1])):
        greater |= equal & other[:, bit] & ~one[:, bit]
        equal &= ~(other[:, bit] ^ one[:, bit])
    return one & ~greater[:, None] | other & greater[:, None]
