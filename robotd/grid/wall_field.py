"""What refinement needs of a map: how far it is to the nearest wall from anywhere, and how far beams go.

Two bytes a cell, made once for a map and made anew only round what changed; see :mod:`robotd.grid.kernels.fitting`.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.grid import kernels
from robotd.grid.kernels.fitting import DEPTH_CELLS, REACH_CELLS, SKIP_MAX
from robotd.grid.spec import GridSpec

Window = tuple[slice, slice]
"""Rows and columns."""


class WallField:
    """The walls of one map; two bytes a cell."""

    def __init__(self, spec: GridSpec, walls: NDArray[np.bool_], blocking: NDArray[np.bool_]) -> None:
        """Prepare a map.

        Args:
            spec: where the cells lie.
            walls: ``bool[rows, cols]``: the cells that can end a reading.
            blocking: ``bool[rows, cols]``: the cells that stop a beam; walls always do, whatever this says.

        O(cells).
        """
        self.spec = spec
        self.codes = kernels.wall_codes(walls)
        """``int8[rows, cols]``, squared distances."""
        self.skips = kernels.skip_codes(walls, blocking & ~walls)
        """``uint8[rows + 2, cols + 2]``."""

    def update(self, walls: NDArray[np.bool_], blocking: NDArray[np.bool_], window: Window) -> None:
        """Take over what changed in a window, all else being as before; the result is as if made anew.

        O(cells of the window, and of a rim of 30 cells round it).
        """
        around, inner, outer = _rims(window, max(REACH_CELLS, DEPTH_CELLS), self.spec.shape)
        self.codes[inner] = kernels.wall_codes(np.ascontiguousarray(walls[outer]))[around]
        around, inner, outer = _rims(window, SKIP_MAX, self.spec.shape)
        ends = np.ascontiguousarray(walls[outer])
        skips = kernels.skip_codes(ends, np.ascontiguousarray(blocking[outer]) & ~ends)
        self.skips[1:-1, 1:-1][inner] = skips[1:-1, 1:-1][around]


def _rims(window: Window, rim: int, shape: tuple[int, int]) -> tuple[Window, Window, Window]:
    """Return the cells that a window has influence on, in the window of all cells that influence those, and both."""
    inner = _widened(window, rim, shape)
    outer = _widened(inner, rim, shape)
    rows, cols = (slice(a.start - b.start, a.stop - b.start) for a, b in zip(inner, outer, strict=True))
    return (rows, cols), inner, outer


def _widened(window: Window, rim: int, shape: tuple[int, int]) -> Window:
    rows, cols = (
        slice(max(0, side.start - rim), min(size, side.stop + rim)) for side, size in zip(window, shape, strict=True)
    )
    return rows, cols
