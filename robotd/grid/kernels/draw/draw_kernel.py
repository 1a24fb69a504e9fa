"""Readings drawn on the grid at all headings: chains of cells, and the beams whose bodies begin them."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

NO_HEAD = -(1 << 30)
"""In place of a head's row and column: the reading is a miss, and only its body counts."""
SLOTS = 4096
"""A mebibyte for each thread; a batch fills no more of it than differs from body to body."""


@dataclass(frozen=True, slots=True, eq=False)
class BeamSettings:
    """How readings are drawn on the grid."""

    resolution_m: float
    """Side of one cell."""
    error_radius_cells: float
    """The paper's eps: bodies end this much before their heads."""
    reach_cells: int
    """Where bodies end at the latest; more than the grid is wide and high changes nothing."""


def turned(headings_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return headings as beams are drawn at: angle, sine and cosine, ``float64[3, headings]``."""
    return np.stack((headings_rad, np.sin(headings_rad), np.cos(headings_rad)))


@dataclass(frozen=True, slots=True)
class BeamCounts:
    """How much of everything there is in drawn beams, and so where it stands in their numbers."""

    cell_count: int
    group_count: int
    beam_count: int
    batch_count: int
    heading_count: int
    slots: int


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """Readings drawn on the grid at all headings; what shares a chain of cells is together.

    The body of a beam is the beginning of a chain. Chains are taken in batches, so that what is free up to the ends of
    all bodies of a batch, one slot for each, stays in the cache.
    """

    numbers: NDArray[np.int32]
    """All parts one after the other, as they are named below."""
    drawn: Any
    """A :class:`BeamCounts`; or the struct of the kernel in C, which has the same numbers under the same names."""

    @property
    def chains(self) -> NDArray[np.int32]:
        """``int32[cells, 3]``: ``(row, col)`` offset from the robot's cell, and the slot of the bodies that end here.

        The slot is -1 if none does. Each chain begins with ``(0, 0)``.
        """
        return self._part(0, 3 * self.drawn.cell_count).reshape(-1, 3)

    @property
    def groups(self) -> NDArray[np.int32]:
        """``int32[groups + 1]``: first cell of each chain, and the end of the last."""
        return self._part(3 * self.drawn.cell_count, self.drawn.group_count + 1)

    @property
    def beams(self) -> NDArray[np.int32]:
        """``int32[beams, 3]``: slot of the body, ``(row, col)`` of the head; ``NO_HEAD`` twice for a miss."""
        first = 3 * self.drawn.cell_count + self.drawn.group_count + 1
        return self._part(first, 3 * self.drawn.beam_count).reshape(-1, 3)

    @property
    def batches(self) -> NDArray[np.int32]:
        """``int32[batches + 1]``: first group of each batch, and the end of the last."""
        return self._part(self._lists - self.drawn.batch_count - 1, self.drawn.batch_count + 1)

    @property
    def lists(self) -> NDArray[np.int32]:
        """``int32[batches * headings + 1]``: first beam of each batch and heading, and the end of the last."""
        return self._part(self._lists, self.drawn.batch_count * self.drawn.heading_count + 1)

    @property
    def slots(self) -> int:
        """No batch has more than this many."""
        return int(self.drawn.slots)

    @property
    def _lists(self) -> int:
        cells_and_beams = 3 * (self.drawn.cell_count + self.drawn.beam_count)
        return int(cells_and_beams + self.drawn.group_count + 1 + self.drawn.batch_count + 1)

    def _part(self, first: int, count: int) -> NDArray[np.int32]:
        part: NDArray[np.int32] = self.numbers[first : first + count]
        return part


class DrawKernel(Protocol):
    """Drawing readings on the grid."""

    def draw_beams(self, readings: NDArray[np.float64], headings: NDArray[np.float64], how: BeamSettings) -> Beams:
        """Draw every reading at every heading.

        Each beam has the cells that :mod:`robotd.grid.drawn` gives it.

        Args:
            readings: ``float64[n, 5]``, the rows of :class:`~robotd.grid.readings.Readings`.
            headings: ``float64[3, headings]`` of :func:`~robotd.grid.kernels.draw.draw_kernel.turned`.
            how: resolution and error radius.

        Returns:
            The beams. The kernel in C gives the same beams, in groups and slots that may be numbered otherwise.
        """
