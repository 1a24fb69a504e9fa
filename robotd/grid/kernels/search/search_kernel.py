"""What the search keeps of a map: bitmaps in windows and in blocks, and distances; filled by the kernels."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from robotd.grid.error_radii import ErrorRadii
from robotd.grid.pose_set import PoseSet
from robotd.grid.window import CellWindow

BUDGET_MAX = 1 << 62
"""More than can ever be looked at."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """A map as the search reads it; the arrays of :class:`robotd.localization.obstacles.beam_obstacles.Obstacles`."""

    free: NDArray[np.bool_]
    blocking: NDArray[np.bool_]
    """Both ``bool[rows, cols]``, contiguous."""
    grown: NDArray[np.bool_]
    """``bool[levels, rows, cols]``, contiguous: by each of the radii."""
    outside_blocks: bool
    outside_ends: bool
    blocked_by: int
    radii: ErrorRadii


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
    """``float64[n, 5]``, as :class:`~robotd.grid.readings.Readings` has them; at least one, at most 65535."""
    headings_rad: NDArray[np.float64]
    resolution_m: float
    slack: int
    """Poses are wanted that explain this many readings fewer than the best."""
    least_rank: int
    """Nothing is wanted if the best explains fewer."""
    limit: int
    """How many poses at most."""
    window: CellWindow
    """Poses are wanted in these cells, as far as ``spans`` says; inside the map."""
    by_blocks: bool
    """Whether to bound blocks of cells first; for a window of a few windows it does not pay."""
    spans: NDArray[np.int32]
    """``int32[rows of the window, 2]``: in each row, the first column where poses are wanted, and the one
    after the last."""
    reach_cells: float
    """Where bodies end at the latest; more than the map is wide and high changes nothing."""
    budget: int = BUDGET_MAX
    """How much may be looked at, whatever the time is: as long as it takes on one machine, on any machine the same is
    found. Headings are searched in an order, and when it is spent, or a heading takes more than its share of what is
    left, the poses that were found are not all. What counts is for each kernel to say."""


class SearchKernel(Protocol):
    """Searching for the best poses."""

    def make_planes(self, ground: Ground) -> Planes:
        """Return what the search keeps of a map; the twin reads the map itself and keeps nothing more."""

    def renew_planes(self, planes: Planes, ground: Ground, window: CellWindow) -> Planes:
        """Return the planes after cells changed, all of them in a window; the old ones stay as they are."""

    def search_poses(self, planes: Planes, question: Question, *, threads: int = 1) -> PoseSet:
        """Return the best poses.

        Heading by heading, cells that may hold an answer are kept in a list, and dropped once they have missed too many
        readings: first by the heads of all beams, then, only where the heads leave a chance, by their bodies.
        """
