"""Looking at packed maps from elsewhere, and counting in bit-sliced counters, in NumPy: what the twins share."""

import numpy as np

from robotd.grid.kernels.shared.packed_map import PAD_WORDS, TILE_ROWS, WORD_CELLS, PackedMap, Words


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
    # Without a shift the word beside it would be shifted by all of its 64 bits, which is undefined.
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
