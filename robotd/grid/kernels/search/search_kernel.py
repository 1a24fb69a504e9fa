"""What the search keeps of a map: bitmaps in windows and in blocks, and distances; filled by the kernels."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Window = tuple[slice, slice]
"""Rows and columns, from a first to before a last."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """A map as the search reads it; the arrays of :class:`robotd.localization.obstacles.beam_obstacles.Obstacles`."""

    free: NDArray[np.bool_]
    blocking: NDArray[np.bool_]
    grown: NDArray[np.bool_]
    """All ``bool[rows, cols]``, contiguous."""
    outside_blocks: bool
    outside_ends: bool
    blocked_by: int
    error_radius_cells: float

    @property
    def everywhere(self) -> "Window":
        """The window that holds all cells."""
        return slice(0, self.free.shape[0]), slice(0, self.free.shape[1])


@dataclass(frozen=True, slots=True, eq=False)
class Planes:
    """What the search keeps; ``c/planes.h`` describes the arrays.

    Bytes for every cell: 0.4 to 0.5 for ``cells``, 1 for ``near``, and for ``pooled`` 6 at 4096 x 4096 cells, 11 at
    1024 x 1024 and 53 at 256 x 256, most of which stands for what lies outside and is seldom read.
    """

    ground: Ground
    key_of: NDArray[np.int8]
    """``int8[33, 33]``: a number from 1 for where a body ends, seen from its head; 0 where none does."""
    cells: NDArray[np.uint16]
    pooled: NDArray[np.uint64]
    near: NDArray[np.uint8]
    handle: Any
    """What the kernels in C know it by, which holds no array alive; None for the twin."""


@dataclass(frozen=True, slots=True, eq=False)
class Question:
    """What is asked of a search."""

    readings: NDArray[np.float64]
    """``float64[n, 5]``, as :func:`robotd.grid.readings.numbers_of` returns them; at least one, at most 65535."""
    headings_rad: NDArray[np.float64]
    resolution_m: float
    slack: int
    """Poses are wanted that explain so many readings fewer than the best."""
    least_rank: int
    """Nothing is wanted if the best explains fewer."""
    limit: int
    """How many poses at most."""
    area: tuple[int, int, int, int]
    """Rows from the first to before the second, columns from the third to before the fourth; inside the map."""
    by_blocks: bool
    """Whether to bound blocks of cells first; for an area of a few windows it does not pay."""
    spans: NDArray[np.int32]
    """``int32[rows of the area, 2]``: in each row, the first column where poses are wanted, and the one
    after the last."""
    reach_cells: float
    """Where bodies end at the latest; more than the map is wide and high changes nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What a search found."""

    best_rank: int
    """The greatest rank, or 0 if it is less than what was asked for."""
    least: int
    """Every pose of at least this rank is here and no other: the best rank less the slack, at least 1; or more, where
    there are more poses than the limit: then the least rank that leaves no more."""
    poses: NDArray[np.int32]
    """``int32[n, 4]``, ``(heading, row, col, rank)`` in this order."""
