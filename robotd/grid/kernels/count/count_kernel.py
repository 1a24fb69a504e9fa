"""Counting feasible poses: what the kernel does."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.draw.draw_kernel import Beams
from robotd.grid.kernels.shared.packed_map import PackedMap, Words


class CountKernel(Protocol):
    """Counting feasible poses."""

    def count_feasible(
        self,
        counters: Words,
        the_map: PackedMap,
        beams: Beams,
        *,
        subtract: bool = False,
        threads: int = 1,
    ) -> None:
        """Count every beam at every cell from which it is feasible, FP = D - E of [BrownDonald2000]_ sec. 2.2.1.

        Args:
            counters: ``uint64[tiles, headings, bits, 32]``, bit-sliced, changed in place; the caller makes sure that no
                count outgrows its bits.
            the_map: the obstacles.
            beams: drawn for the headings of the counters.
            subtract: take beams back that were counted before.
            threads: how many threads share the work, where it can be shared; the result does not depend on it.

        O(cells / 64) for every cell of every chain and for every beam.
        """

    def greatest(self, counters: Words) -> int:
        """Return the greatest count."""

    def at_least(self, counters: Words, the_map: PackedMap, least: int) -> Words:
        """Return where the count is at least so great, ``uint64[headings, rows, words]``; no bit outside the tiles.

        Args:
            counters: ``uint64[tiles, headings, bits, 32]``.
            the_map: the map that they belong to.
            least: not negative.
        """

    def heat(
        self,
        counters: Words,
        the_map: PackedMap,
        first: tuple[int, int],
        shape: tuple[int, int],
        *,
        readings: int,
        block: int,
    ) -> NDArray[np.uint8]:
        """Return the greatest count of each cell over all headings, ``uint8[rows / block, cols / block]``, rounded up.

        255 is a count of all readings, what is less is rounded down; a level is the greatest of ``block x block``
        cells.

        Args:
            counters: ``uint64[tiles, headings, bits, 32]``, of one heading or more; no count is above ``readings``.
            the_map: the map that they belong to.
            first: row and column, counted from the first tile, of the first cell to look at.
            shape: how many ``(rows, cols)`` to look at, none of them beyond the tiles.
            readings: how many were counted, one or more.
            block: how many cells along a side share a level, one or more.
        """
