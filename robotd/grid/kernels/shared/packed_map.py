"""How a map is packed for the kernels: 64 cells a word, words of one column together, its outside all round.

Bit ``b`` of word ``w`` of a row is column ``64 w + b``. Words that lie above each other are neighbours in memory, so
that a vector holds the same word of successive rows, and the map shifted by any offset is two loads and one funnel
shift. Two columns of words and 32 rows lie round the map, all ones or all zeros: what is outside needs no branch.
A tile is 32 rows of one column of words; counts are kept for tiles, in bit-sliced counters ``uint64[tiles, headings,
bits, 32]``: plane ``p`` holds bit ``p`` of all counts.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

TILE_ROWS = 32
WORD_CELLS = 64
PAD_WORDS = 2
"""Columns of words on either side: what is two words outside is all outside, and so is its right neighbour."""
BITS_MIN = 3
"""Seven planes are added at once: their sum needs three bits."""
_LINE_WORDS = 8
"""Of a cache line, and of the widest vector. As in arena.h."""

Words = NDArray[np.uint64]


def pack(mask: NDArray[np.bool_], origin: tuple[int, int] = (0, 0), *, outside: bool) -> Words:
    """Return a mask packed as above, ``uint64[words + 4, rows + padding]``.

    Args:
        mask: ``bool[rows, cols]``.
        origin: row and column, within the first tile, where the mask begins.
        outside: what lies beyond the mask.
    """
    (top, left), (rows, cols) = origin, mask.shape
    padding = (
        (TILE_ROWS + top, TILE_ROWS + -(top + rows) % TILE_ROWS),
        (PAD_WORDS * WORD_CELLS + left, PAD_WORDS * WORD_CELLS + -(left + cols) % WORD_CELLS),
    )
    padded = np.pad(mask, padding, constant_values=outside)
    return np.ascontiguousarray(np.packbits(padded, axis=1, bitorder="little").view("<u8").astype(np.uint64).T)


def unpack(words: Words, cols: int) -> NDArray[np.bool_]:
    """Return ``bool[..., cols]`` of rows of words ``uint64[..., words]``."""
    # On a big-endian machine the bytes of a word, and with them the cells, would come the other way round.
    octets = np.ascontiguousarray(words.astype("<u8")).view(np.uint8)
    return np.unpackbits(octets, axis=-1, count=cols, bitorder="little").view(np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class PackedMap:
    """What a map means to a reading (:mod:`.beam_obstacles`), packed, and the tiles with free cells."""

    planes: Words
    """``uint64[5, words + 4, rows + 64]``, as named below."""
    tiles: NDArray[np.int32]
    """``int32[tiles, 2]``: column of words, and first row, of every tile with a free cell."""
    shape: tuple[int, int]
    """``(rows, cols)`` of the map before it was packed."""
    origin: tuple[int, int]
    """Row and column, within the first tile, of the map's first cell: such that the free cells begin with a tile."""
    blocked_by: int
    """How many blocking cells a body must meet to be blocked, 1 or 2."""

    @classmethod
    def of(
        cls,
        free: NDArray[np.bool_],
        blocking: NDArray[np.bool_],
        grown: NDArray[np.bool_],
        *,
        outside_blocks: bool = True,
        outside_ends: bool = True,
        blocked_by: int = 1,
    ) -> "PackedMap":
        """Pack the three masks ``bool[rows, cols]`` of a map, and what lies outside."""
        # Tiles begin where the free cells do, for only tiles with a free cell are counted, and each costs memory.
        first_row, first_col = int(free.any(axis=1).argmax()), int(free.any(axis=0).argmax())
        origin = -first_row % TILE_ROWS, -first_col % WORD_CELLS
        rows, cols = free.shape
        planes = planes_of(
            pack(free, origin, outside=False),
            pack(blocking, origin, outside=outside_blocks),
            pack(grown, origin, outside=outside_ends),
        )
        return cls(planes, tiles_of(planes[0]), (rows, cols), origin, blocked_by)

    @property
    def free(self) -> Words:
        """Where the robot may stand; nowhere outside."""
        plane: Words = self.planes[0]
        return plane

    @property
    def blocking(self) -> Words:
        """What stops a beam."""
        plane: Words = self.planes[1]
        return plane

    @property
    def grown(self) -> Words:
        """What can end a beam, grown by the error radius."""
        plane: Words = self.planes[2]
        return plane

    @property
    def stopping(self) -> Words:
        """OR of 32 rows of the blocking ones, from each row on: the columns of a tile in which a beam can stop."""
        plane: Words = self.planes[3]
        return plane

    @property
    def ending(self) -> Words:
        """The same of the grown ones: the columns in which a beam can end."""
        plane: Words = self.planes[4]
        return plane

    @property
    def words(self) -> int:
        """Columns of words, without the padding."""
        return int(self.planes.shape[1]) - 2 * PAD_WORDS

    @property
    def rows(self) -> int:
        """Rows, a multiple of the tile's."""
        return int(self.planes.shape[2]) - 2 * TILE_ROWS

    def counter_bytes(self, headings: int, bits: int) -> int:
        """Return how much memory counters take: 256 bytes for every tile, heading and bit."""
        return len(self.tiles) * headings * max(bits, BITS_MIN) * TILE_ROWS * 8

    def blank_counters(self, headings: int, bits: int) -> Words:
        """Return counters that have counted nothing."""
        shape = (len(self.tiles), headings, max(bits, BITS_MIN), TILE_ROWS)
        size = math.prod(shape)
        words = np.zeros(size + _LINE_WORDS - 1, np.uint64)
        # From a cache line on: NumPy begins large arrays 16 bytes after one, and each vector would lie across two.
        past = words.ctypes.data // words.itemsize % _LINE_WORDS
        first = (_LINE_WORDS - past) % _LINE_WORDS
        return words[first : first + size].reshape(shape)


def planes_of(free: Words, blocking: Words, grown: Words) -> Words:
    """Return the five planes of a packed map from its three masks, packed."""
    planes = np.stack((free, blocking, grown, blocking, grown))
    # The last 31 rows have no whole tile below them; they are padding, whose own value is right.
    planes[3:, :, : 1 - TILE_ROWS] = any_of_a_tile(planes[1:3])
    return planes


def any_of_a_tile(planes: Words) -> Words:
    """Return the OR of each word and the 31 below it, ``uint64[..., rows - 31]`` of ``uint64[..., rows]``."""
    # Doubling: five ORs for 32 rows.
    for step in (1, 2, 4, 8, 16):
        planes = planes[..., :-step] | planes[..., step:]
    return planes


def tiles_of(free: Words) -> NDArray[np.int32]:
    """Return the tiles of a packed plane that have a set bit, ``int32[tiles, 2]`` as ``(word, first row)``."""
    inner = free[PAD_WORDS:-PAD_WORDS, TILE_ROWS:-TILE_ROWS]
    blocks = inner.reshape(inner.shape[0], -1, TILE_ROWS).any(axis=2)
    return np.ascontiguousarray(np.argwhere(blocks) * (1, TILE_ROWS), np.int32)
