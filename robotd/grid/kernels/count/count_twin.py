"""Counting feasible poses, in NumPy: the twin of the kernel in C."""

import itertools

import numpy as np

from robotd.grid.kernels.draw.draw_kernel import NO_HEAD, Beams
from robotd.grid.kernels.shared.packed_map import PAD_WORDS, TILE_ROWS, WORD_CELLS, PackedMap, Words


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
        better = best & counters[:, :, bit]
        if better.any():
            best, value = better, value | 1 << bit
    return value


def at_least(counters: Words, the_map: PackedMap, least: int) -> Words:
    """See :class:`.CountKernel`."""
    _, headings, bits, _ = counters.shape
    masks = np.zeros((headings, the_map.rows, the_map.words), np.uint64)
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


def seen_from(packed: Words, row: int, col: int) -> Words:
    """Return the map shifted so that each cell holds what lies at an offset from it, ``uint64[words, rows]``."""
    words, rows = packed.shape[0] - 2 * PAD_WORDS, packed.shape[1] - 2 * TILE_ROWS
    word, shift = divmod(col, WORD_CELLS)
    first_word, first_row = max(0, -PAD_WORDS - word), max(0, -TILE_ROWS - row)
    last_word, last_row = min(words, words + 1 - word), min(rows, rows + TILE_ROWS - row)
    seen = np.full((words, rows), packed[0, 0])  # the corner is outside, as all of the padding
    if first_word >= last_word or first_row >= last_row:
        return seen
    there = slice(first_row + row + TILE_ROWS, last_row + row + TILE_ROWS)
    low: Words = packed[first_word + word + PAD_WORDS : last_word + word + PAD_WORDS, there]
    if shift:
        high: Words = packed[first_word + word + PAD_WORDS + 1 : last_word + word + PAD_WORDS + 1, there]
        low = (low >> np.uint64(shift)) | (high << np.uint64(WORD_CELLS - shift))
    seen[first_word:last_word, first_row:last_row] = low
    return seen


def tiles_of_plane(plane: Words, the_map: PackedMap) -> Words:
    """Return the tiles ``uint64[tiles, 32]`` of a plane ``uint64[words, rows]``."""
    blocks = plane.reshape(the_map.words, -1, TILE_ROWS)
    tiles: Words = blocks[the_map.tiles[:, 0], the_map.tiles[:, 1] // TILE_ROWS]
    return tiles


def ripple(counter: Words, carry: Words, *, subtract: bool) -> None:
    """Add one bit to ``uint64[tiles, bits, 32]``, or take it away."""
    for bit in range(counter.shape[1]):
        old = counter[:, bit].copy()
        counter[:, bit] ^= carry
        carry = carry & (~old if subtract else old)
        if not carry.any():
            return
