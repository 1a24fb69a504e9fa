"""Where on the grid the robot is known to be: a disk, in cells."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.core.grid_spec import GridSpec
from robotd.grid.window import CellWindow


@dataclass(frozen=True, slots=True)
class CellDisk:
    """Cells whose centre is near to a place; all lengths in cells, ``(r, c)`` being the centre of that cell."""

    row: float
    col: float
    radius: float

    @classmethod
    def of(cls, area: Area, spec: GridSpec) -> "CellDisk":
        """Return an area in cells: those whose centres lie within."""
        scale = 1.0 / spec.resolution_m
        # Less a half: whole numbers are then centres, as indices are.
        row, col = (area.y_m - spec.origin_y_m) * scale - 0.5, (area.x_m - spec.origin_x_m) * scale - 0.5
        return cls(row, col, area.radius_m * scale)

    def spans(self, shape: tuple[int, int]) -> tuple[CellWindow, NDArray[np.int32]]:
        """Return the window of a grid that holds the disk, and from which to before which column each row is in it."""
        first = max(0, math.ceil(self.row - self.radius))
        end = max(first, min(shape[0], math.floor(self.row + self.radius) + 1))
        # In the outermost rows rounding may leave the square just below 0.
        halves = [math.sqrt(max(self.radius**2 - (row - self.row) ** 2, 0.0)) for row in range(first, end)]
        spans = [(max(0, math.ceil(self.col - h)), min(shape[1], math.floor(self.col + h) + 1)) for h in halves]
        left, right = min((span[0] for span in spans), default=0), max((span[1] for span in spans), default=0)
        if left >= right:
            return CellWindow(0, 0, 0, 0), np.zeros((0, 2), np.int32)
        return CellWindow(first, end, left, right), np.array(spans, np.int32)

    def touches(self, cells: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return which cells ``intp[n, 2]`` may have a point in the disk, ``bool[n]``: half a diagonal does no harm."""
        near: NDArray[np.bool_] = (
            np.hypot(cells[:, 0] - self.row, cells[:, 1] - self.col) <= self.radius + _HALF_DIAGONAL
        )
        return near


_HALF_DIAGONAL = math.sqrt(0.5)
