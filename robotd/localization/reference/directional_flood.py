"""The flood in one direction ([BrownDonald2000]_ sec. 2.3.2, figs. 16, 19): where a ray first meets a source.

Pushing sources back along a pixelized vector, one cell at a time, loses some of them. A cell bears one number, that of
its nearest source; the sources behind that one come through the cell too, and where their chains part from its chain
they must go on. The paper's remedy is a *look-ahead*: from a cell numbered ``i``, number also the next cell of the
chain that a copy of the chain, translated by one pixel in the dominant direction, does not cover.

**That is not enough.** It is right for sources in line along the dominant axis, hence for the solid obstacles of
fig. 16. But a nearer source may as well lie a row to the side, and then its chain parts from the farther one's
elsewhere. Two sources that touch at a corner, as in every wall at a slant, are enough (``#``; the flood runs to the
left along the offsets (0, 0) (0, 1) (1, 2) (1, 3) (1, 4) (1, 5), taken off; ``x`` is what the look-ahead misses)::

    . . . . . o #
    . x x x o # .
    o o o o . . .

The upper source's number 2 falls on a cell that has number 1 from the lower one. The look-ahead trusts the lower chain
to cover the row up to the next step down of the upper chain; but the lower chain steps down at once. Which cell comes
next depends on how the two sources lie to each other, and several may be waiting behind one number.

**What makes it right** is another order of the one sweep. Take parallel lines in the direction of the flood, and let
them slide sideways by the height of one cell: each then leaves one cell of every column for the next one of that
column, once. In the order in which sliding lines meet cell centres, a chain differs from the one before by about one
cell. So this sweep

- holds, for all rows at once, the cells that a chain runs through, as bits;
- takes the columns in the order in which the sliding lines meet the centres of their cells;
- at each, moves the columns in which the chain has changed, and looks up each line's next set bit.

What to move is told by the offsets of the chain itself, not by its slope: the result is the convolution's whatever the
chain is, and only the cost rests on the order. Measured at 256 x 256, a column is moved about twice in all; up to 9
times where samples fall just on the edges between cells, and rounding puts some to this side and some to that. A next
set bit is found in two words of 64 bits, so there are at most 4096 cells along the beam.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.localization.reference.floods import UNREACHED

_WORD_BITS = 64
_ONE = np.uint64(1)
_ALL = ~np.uint64(0)
_NEVER = np.iinfo(np.int32).max
CELLS_MAX = _WORD_BITS * _WORD_BITS
"""Greatest size of a grid along the dominant axis of a flood."""


def directional_flood(
    sources: NDArray[np.bool_], chain: NDArray[np.intp], *, outside: bool = False
) -> NDArray[np.int32]:
    """Return where each cell's ray first meets a source, ``int32[rows, cols]``: an index into the chain, -1 if nowhere.

    Cell ``p`` is numbered with the smallest ``k`` for which ``p + chain[k]`` is a source: the flood of the sources
    against the direction of the chain, out to its length. The numbered cells are the convolution of the sources with
    the chain, and what a shorter piece of the chain numbers are the numbers less than its length.

    O(cells), however long the chain is, if it is straight (:func:`is_ray`). [BrownDonald2000]_ sec. 2.3.2, fig. 19.

    Args:
        sources: ``bool[rows, cols]``.
        chain: ``intp[n, 2]``, a pixelized vector as ``(row, col)`` offsets, from (0, 0) on; every offset is one cell
            farther along the dominant axis than the one before and at most one cell sideways, as
            :func:`.pixelized_vector.ray_offsets` returns them.
        outside: whether what lies beyond the grid is a source.

    Raises:
        ValueError: the chain is none, or the grid has more than 4096 cells along its dominant axis.
    """
    if not _is_chain(chain):
        raise ValueError("a chain begins at (0, 0), goes on by one cell along one axis, and by at most one sideways")
    # Seen so that the chain runs along +col.
    along = _dominant_axis(chain)
    forward = int(chain[1, along]) if len(chain) > 1 else 1
    seen = (sources if along == 1 else sources.T)[:, ::forward]
    numbers = _flood_along_cols(seen, chain[:, 1 - along], outside=outside)[:, ::forward]
    return np.ascontiguousarray(numbers if along == 1 else numbers.T)


def is_ray(offsets: NDArray[np.intp]) -> bool:
    """Return whether offsets ``intp[n, 2]`` are those of a straight line from the centre of cell (0, 0).

    The chains that are flooded in O(cells); others are flooded too, but may take as long as the convolution.
    """
    if not _is_chain(offsets):
        return False
    low, high = _slope_bounds(offsets[:, 1 - _dominant_axis(offsets)])
    return low <= high


def _is_chain(offsets: NDArray[np.intp]) -> bool:
    steps = np.diff(offsets, axis=0)
    begins = len(offsets) > 0 and not offsets[0].any()
    straight = _is_straight(steps[:, 0]) or _is_straight(steps[:, 1])
    return begins and straight and bool(np.abs(steps).max(initial=0) <= 1)


def _dominant_axis(chain: NDArray[np.intp]) -> int:
    return 1 if _is_straight(np.diff(chain[:, 1])) else 0


def _is_straight(steps: NDArray[np.intp]) -> bool:
    """Whether each step is one cell the same way."""
    return bool((steps == steps[:1]).all() and (np.abs(steps) == 1).all())


def _flood_along_cols(sources: NDArray[np.bool_], aside: NDArray[np.intp], *, outside: bool) -> NDArray[np.int32]:
    """Flood along rays through ``(row + aside[k], col + k)``."""
    rows, cols = sources.shape
    if cols > CELLS_MAX:
        raise ValueError(f"expected at most {CELLS_MAX} cells along the flood, got {cols}")
    drift = sum(_slope_bounds(aside[:cols])) / 2.0 * np.arange(cols)
    anchors = np.ceil(drift).astype(np.intp)
    lines = _Lines(sources, anchors, outside=outside)
    # The edge itself is a source a column beyond the last one, or there is none.
    edges = cols if outside else cols + len(aside)
    numbers = np.empty((rows, cols), np.int32)
    # The order in which lines that slide sideways meet the cell centres; any order is right, only this one is O(cells).
    for col in np.argsort(anchors - drift, kind="stable").tolist():
        lines.move(col, anchors[col] + aside[: cols - col])
        numbers[:, col] = np.minimum(lines.first_set(col, int(anchors[col])), edges) - col
    numbers[numbers >= len(aside)] = UNREACHED
    return numbers


def _slope_bounds(aside: NDArray[np.intp]) -> tuple[float, float]:
    """Return the least and the greatest slope with which a line from the centre of a cell runs through these cells."""
    if len(aside) < 2:
        return 0.0, 0.0
    steps = np.arange(1, len(aside))
    return float(((aside[1:] - 0.5) / steps).max()), float(((aside[1:] + 0.5) / steps).min())


class _Lines:
    """The cells of parallel pixelized lines as bits, one for every column; each column can be moved by itself.

    Line ``n`` runs through row ``n - top + shift[col]`` of a column.
    """

    def __init__(self, sources: NDArray[np.bool_], anchors: NDArray[np.intp], *, outside: bool) -> None:
        self._columns = np.ascontiguousarray(sources.T)
        self._outside = outside
        self._top = int(anchors.max())
        cols, rows = self._columns.shape
        count = rows + self._top - int(anchors.min())
        self._shifts = np.full(cols, np.iinfo(np.intp).max)
        self._words = np.zeros((-(-cols // _WORD_BITS), count), np.uint64)
        # A second level, so that a next set bit is found in two words however long the line is.
        self._filled = np.zeros(count, np.uint64)
        """Which words of a line have any bit set."""

    def move(self, first_col: int, shifts: NDArray[np.intp]) -> None:
        """Shift the columns from one on, those that are not there yet."""
        current = self._shifts[first_col : first_col + len(shifts)]
        changed = np.flatnonzero(current != shifts)
        for col in changed.tolist():
            self._set_column(first_col + col, int(shifts[col]))
        current[changed] = shifts[changed]

    def first_set(self, col: int, shift: int) -> NDArray[np.intp]:
        """Return the first column from ``col`` on that is set, of the lines through each row of ``col``.

        Where there is none, a number beyond all columns.
        """
        rows = self._columns.shape[1]
        lines = slice(self._top - shift, self._top - shift + rows)
        word, bit = divmod(col, _WORD_BITS)
        here = self._words[word, lines] & (_ALL << np.uint64(bit))
        later = self._filled[lines] & (_ALL << np.uint64(word) << np.uint64(1))
        next_word = np.where(here != 0, word, _lowest_bit(later))
        bits = np.where(here != 0, here, self._words[next_word, np.arange(lines.start, lines.stop)])
        return np.where(next_word >= 0, next_word * _WORD_BITS + _lowest_bit(bits), _NEVER)

    def _set_column(self, col: int, shift: int) -> None:
        word, bit = divmod(col, _WORD_BITS)
        cells = np.full(len(self._filled), self._outside)
        first = self._top - shift
        column = self._columns[col]
        begin = max(0, first)
        end = max(begin, min(len(cells), first + len(column)))  # a chain that is no ray may lead past all lines
        cells[begin:end] = column[begin - first : end - first]
        self._words[word] &= ~(_ONE << np.uint64(bit))
        self._words[word] |= cells.astype(np.uint64) << np.uint64(bit)
        self._filled &= ~(_ONE << np.uint64(word))
        self._filled |= (self._words[word] != 0).astype(np.uint64) << np.uint64(word)


def _lowest_bit(words: NDArray[np.uint64]) -> NDArray[np.intp]:
    """Return the number of the lowest bit set in each word, -1 where none is."""
    # A single bit is a power of two, which a float holds exactly: its exponent is the number of the bit.
    lowest = words & (~words + _ONE)
    exponents = np.frexp(lowest.astype(np.float64))[1]
    return exponents.astype(np.intp) - 1
