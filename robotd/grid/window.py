"""A rectangle of cells: what a change of the map can have touched."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class CellWindow:
    """The cells of ``first_row <= row < end_row`` and ``first_col <= col < end_col``, all of them on the grid."""

    first_row: int
    end_row: int
    first_col: int
    end_col: int

    @classmethod
    def whole(cls, shape: tuple[int, ...]) -> "CellWindow":
        """Return all cells of a grid ``(rows, cols)``."""
        return cls(0, shape[0], 0, shape[1])

    @classmethod
    def bounding(cls, cells: NDArray[np.intp], shape: tuple[int, ...]) -> "CellWindow":
        """Return the smallest window that holds cells of a grid, an empty one if there are none.

        Args:
            cells: ``intp[n]``, flat indices ``row * cols + col``, ascending, as an insertion returns them.
            shape: ``(rows, cols)`` of the grid.
        """
        if not cells.size:
            return cls(0, 0, 0, 0)
        cols = cells % shape[1]
        # Ascending, so the first and the last tell the rows; columns come in any order.
        first_row, last_row = int(cells[0]) // shape[1], int(cells[-1]) // shape[1]
        return cls(first_row, last_row + 1, int(cols.min()), int(cols.max()) + 1)

    def on(self, shape: tuple[int, ...]) -> "CellWindow":
        """Return the part of a rectangle that lies on a grid ``(rows, cols)``, empty if there is none.

        >>> CellWindow(-2, 4, 5, 90).on((6, 20))
        CellWindow(first_row=0, end_row=4, first_col=5, end_col=20)
        """
        first_row, end_row = max(0, self.first_row), min(shape[0], self.end_row)
        first_col, end_col = max(0, self.first_col), min(shape[1], self.end_col)
        inside = CellWindow(first_row, end_row, first_col, end_col)
        return CellWindow(0, 0, 0, 0) if inside.is_empty else inside

    def grown(self, by_cells: int, shape: tuple[int, ...]) -> "CellWindow":
        """Return this window with this many cells more on every side, as far as the grid goes; empty stays empty.

        >>> CellWindow(2, 4, 0, 9).grown(3, (6, 20))
        CellWindow(first_row=0, end_row=6, first_col=0, end_col=12)
        """
        if self.is_empty:
            return self
        return CellWindow(
            max(0, self.first_row - by_cells),
            min(shape[0], self.end_row + by_cells),
            max(0, self.first_col - by_cells),
            min(shape[1], self.end_col + by_cells),
        )

    def moved(self, by_cells: int) -> "CellWindow":
        """Return the window of the same cells where rows and columns are counted from ``by_cells`` cells before.

        >>> CellWindow(2, 4, 0, 9).moved(3)
        CellWindow(first_row=5, end_row=7, first_col=3, end_col=12)
        """
        return CellWindow(
            self.first_row + by_cells, self.end_row + by_cells, self.first_col + by_cells, self.end_col + by_cells
        )

    def joined(self, other: "CellWindow") -> "CellWindow":
        """Return the smallest window that holds this one and another.

        >>> CellWindow(2, 4, 0, 9).joined(CellWindow(3, 7, 5, 6))
        CellWindow(first_row=2, end_row=7, first_col=0, end_col=9)
        """
        if self.is_empty or other.is_empty:
            return other if self.is_empty else self
        return CellWindow(
            min(self.first_row, other.first_row),
            max(self.end_row, other.end_row),
            min(self.first_col, other.first_col),
            max(self.end_col, other.end_col),
        )

    @property
    def is_empty(self) -> bool:
        """Whether there is no cell in it."""
        return self.first_row >= self.end_row or self.first_col >= self.end_col

    @property
    def shape(self) -> tuple[int, int]:
        """Its ``(rows, cols)``."""
        return self.end_row - self.first_row, self.end_col - self.first_col

    @property
    def size(self) -> int:
        """How many cells it has, if it is not empty."""
        rows, cols = self.shape
        return rows * cols

    @property
    def slices(self) -> tuple[slice, slice]:
        """Return what an array of cells is indexed with."""
        return slice(self.first_row, self.end_row), slice(self.first_col, self.end_col)


def influence(changed: CellWindow, reach: int, shape: tuple[int, int]) -> tuple[CellWindow, CellWindow, CellWindow]:
    """Return what must be made again where each cell depends on those within reach of it, and of what.

    Args:
        changed: the cells that changed.
        reach: how far cells are depended on, over sides or corners.
        shape: of the map.

    Returns:
        The cells to make again, in the map; the same in the part of the map that they depend on; and that part.
    """
    influenced = changed.grown(reach, shape)
    # Twice: the cells to make again depend on others as far outside of themselves.
    part = influenced.grown(reach, shape)
    row, col = influenced.first_row - part.first_row, influenced.first_col - part.first_col
    rows, cols = influenced.shape
    return influenced, CellWindow(row, row + rows, col, col + cols), part
