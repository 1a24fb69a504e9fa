"""How a map is packed for the kernels: 64 cells a word, words of one column together, ones all round.

Bit ``b`` of word ``w`` of a row is column ``64 w + b``. Words that lie above each other are neighbours in memory, so
that a vector holds the same word of successive rows, and the map shifted by any offset is two loads and one funnel
shift. Two columns of words and 32 rows of ones lie round the map: whatever is outside is occupied, without a branch.
A tile is 32 rows of one column of words; counts are kept for tiles, in bit-sliced counters ``uint64[tiles, headings,
bits, 32]``: plane ``p`` holds bit ``p`` of all counts.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

TILE_ROWS = 32
WORD_CELLS = 64
PAD_WORDS = 2
"""Columns of words on either side: what is two words outside is all outside, and so is its right neighbour."""
BITS_MIN = 3
"""Seven planes are added at once: their sum needs three bits."""

Words = NDArray[np.uint64]


def pack(mask: NDArray[np.bool_]) -> Words:
    """Return a mask ``bool[rows, cols]`` packed as above, ``uint64[words + 4, rows + padding]``, ones outside."""
    rows, cols = mask.shape
    padding = (
        (TILE_ROWS, TILE_ROWS + -rows % TILE_ROWS),
        (PAD_WORDS * WORD_CELLS, PAD_WORDS * WORD_CELLS + -cols % WORD_CELLS),
    )
    padded = np.pad(mask, padding, constant_values=True)
    return np.ascontiguousarray(np.packbits(padded, axis=1, bitorder="little").view("<u8").astype(np.uint64).T)


def unpack(words: Words, cols: int) -> NDArray[np.bool_]:
    """Return ``bool[..., cols]`` of rows of words ``uint64[..., words]``."""
    octets = np.ascontiguousarray(words.astype("<u8")).view(np.uint8)
    return np.unpackbits(octets, axis=-1, count=cols, bitorder="little").view(np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class PackedMap:
    """The obstacles and the grown obstacles of one map, packed, and the tiles that have free cells."""

    occupied: Words
    grown: Words
    tiles: NDArray[np.int32]
    """``int32[tiles, 2]``: column of words, and first row, of every tile with a free cell."""

    @classmethod
    def of(cls, occupied: NDArray[np.bool_], grown: NDArray[np.bool_]) -> "PackedMap":
        """Pack a map ``bool[rows, cols]`` and the same grown by the error radius."""
        packed = pack(occupied)
        inner = ~packed[PAD_WORDS:-PAD_WORDS, TILE_ROWS:-TILE_ROWS]
        blocks = inner.reshape(inner.shape[0], -1, TILE_ROWS).any(axis=2)
        return cls(packed, pack(grown), np.ascontiguousarray(np.argwhere(blocks) * (1, TILE_ROWS), np.int32))

    @property
    def words(self) -> int:
        """Columns of words, without the padding."""
        return int(self.occupied.shape[0]) - 2 * PAD_WORDS

    @property
    def rows(self) -> int:
        """Rows, a multiple of the tile's."""
        return int(self.occupied.shape[1]) - 2 * TILE_ROWS

    def blank_counters(self, headings: int, bits: int) -> Words:
        """Return counters that have counted nothing."""
        return np.zeros((len(self.tiles), headings, max(bits, BITS_MIN), TILE_ROWS), np.uint64)


@dataclass(frozen=True, slots=True, eq=False)
class BeamSettings:
    """How readings are drawn on the grid."""

    resolution_m: float
    """Side of one cell."""
    error_radius_cells: float
    """The paper's eps: bodies end so much before their heads."""
    reach_cells: int
    """Where bodies end at the latest; more than the grid is wide and high changes nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """Readings drawn on the grid at all headings; what shares a chain of cells is together.

    The body of a beam is the beginning of a chain. Chains are taken in batches, so that what is free up to the ends of
    all bodies of a batch, one slot for each, stays in the cache.
    """

    chains: NDArray[np.int32]
    """``int32[cells, 3]``: ``(row, col)`` offset from the robot's cell, and the slot of the bodies that end here, -1 if
    none does. Each chain begins with ``(0, 0)``."""
    groups: NDArray[np.int32]
    """``int32[groups + 1]``: first cell of each chain, and the end of the last."""
    batches: NDArray[np.int32]
    """``int32[batches + 1]``: first group of each batch, and the end of the last."""
    lists: NDArray[np.int32]
    """``int32[batches * headings + 1]``: first beam of each batch and heading, and the end of the last."""
    beams: NDArray[np.int32]
    """``int32[beams, 3]``: slot of the body, ``(row, col)`` of the head. A miss has its head ``FAR_CELLS`` away,
    outside every grid, where all is occupied."""
    slots: int
    """No batch has more than so many."""


FAR_CELLS = 1 << 28
SLOTS = 2048
"""Half a mebibyte for each thread: a batch fits into the second-level cache with room to spare."""


@dataclass(frozen=True, slots=True, eq=False)
class Rays:
    """Beams of one sweep into an occupancy grid; positions and lengths in cells, as in :mod:`robotd.grid.ray`."""

    starts: NDArray[np.float64]
    """``float64[n, 2]``, ``(row, col)``, inside the grid or not."""
    bearings_rad: NDArray[np.float64]
    lengths_cells: NDArray[np.float64]
    hits: NDArray[np.intp]
    """``intp[n]``: flat index of the cell in which each ended, -1 if it met nothing or ended outside the grid."""
