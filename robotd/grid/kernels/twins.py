"""The kernels in NumPy: what the ones in C must do, and what does it where they were not compiled."""

import numpy as np

from robotd.grid.kernels.layout import NO_HEAD, PAD_WORDS, TILE_ROWS, WORD_CELLS, BeamGroups, PackedMap, Words


def count_feasible(
    counters: Words, the_map: PackedMap, groups: BeamGroups, *, subtract: bool = False, threads: int = 1
) -> None:
    """Count every beam at every cell from which it is feasible, FP = D - E of [BrownDonald2000]_ sec. 2.2.1.

    Args:
        counters: ``uint64[tiles, headings, bits, 32]``, bit-sliced, changed in place; the caller makes sure that no
            count outgrows its bits.
        the_map: the obstacles.
        groups: the beams; their headings index the counters.
        subtract: take beams back that were counted before.
        threads: how many threads share the work, where it can be shared; the result does not depend on it.

    O(cells / 64) for every cell of every chain and for every beam.
    """
    for group in range(len(groups.groups) - 1):
        (first_cell, first_beam), (_, last_beam) = groups.groups[group : group + 2].tolist()
        blocked = np.zeros((the_map.words, the_map.rows), np.uint64)
        walked = 0
        for heading, length, head_row, head_col in groups.beams[first_beam:last_beam].tolist():
            for row, col in groups.chains[first_cell + walked : first_cell + length].tolist():
                blocked |= _seen_from(the_map.occupied, row, col)
            walked = length
            feasible = ~blocked if head_row == NO_HEAD else _seen_from(the_map.grown, head_row, head_col) & ~blocked
            _ripple(counters[:, heading], _tiles(feasible, the_map), subtract=subtract)


def greatest(counters: Words) -> int:
    """Return the greatest count."""
    best, value = np.full_like(counters[:, :, 0], ~np.uint64(0)), 0
    for bit in reversed(range(counters.shape[2])):
        better = best & counters[:, :, bit]
        if better.any():
            best, value = better, value | 1 << bit
    return value


def at_least(counters: Words, the_map: PackedMap, least: int) -> Words:
    """Return where the count is at least so great, ``uint64[headings, rows, words]``; no bit is set outside the tiles.

    Args:
        counters: ``uint64[tiles, headings, bits, 32]``.
        the_map: the map that they belong to.
        least: not negative.
    """
    tiles, headings, bits, _ = counters.shape
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


def _seen_from(packed: Words, row: int, col: int) -> Words:
    """Return the map shifted so that each cell holds what lies at an offset from it, ``uint64[words, rows]``."""
    words, rows = packed.shape[0] - 2 * PAD_WORDS, packed.shape[1] - 2 * TILE_ROWS
    shift = np.uint64(col % WORD_CELLS)
    rows_there = np.clip(np.arange(rows) + row, -1, rows) + TILE_ROWS
    low_words = np.clip(np.arange(words) + col // WORD_CELLS, -PAD_WORDS, words) + PAD_WORDS
    low = packed[low_words[:, None], rows_there]
    if shift == 0:
        return low
    return (low >> shift) | (packed[low_words[:, None] + 1, rows_there] << np.uint64(WORD_CELLS - shift))


def _tiles(plane: Words, the_map: PackedMap) -> Words:
    """Return the tiles ``uint64[tiles, 32]`` of a plane ``uint64[words, rows]``."""
    blocks = plane.reshape(the_map.words, -1, TILE_ROWS)
    tiles: Words = blocks[the_map.tiles[:, 0], the_map.tiles[:, 1] // TILE_ROWS]
    return tiles


def _ripple(counter: Words, carry: Words, *, subtract: bool) -> None:
    """Add one bit to ``uint64[tiles, bits, 32]``, or take it away."""
    for bit in range(counter.shape[1]):
        old = counter[:, bit].copy()
        counter[:, bit] ^= carry
        carry = carry & (~old if subtract else old)
        if not carry.any():
            return
