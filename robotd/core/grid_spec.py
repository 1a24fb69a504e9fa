"""Where a grid lies in the map, and nothing else: the only place that knows rows from metres."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

MAX_SIDE_CELLS = 8192
"""More cells than this along one side is a mistake, not a map."""


@dataclass(frozen=True, slots=True)
class GridSpec:
    """Placement of a grid in the map frame.

    Cell ``(row, col)`` covers ``[col, col+1) x [row, row+1)`` cells from the origin:
    ``col`` grows along map +x and ``row`` along map +y.
    """

    resolution_m: float
    """Side of one square cell [m]."""
    origin_x_m: float
    """Lower-left corner of cell ``(0, 0)`` in the map frame [m]."""
    origin_y_m: float
    shape: tuple[int, int]
    """Number of ``(rows, cols)``."""

    def __post_init__(self) -> None:
        """Refuse a grid that has no size."""
        if not (math.isfinite(self.resolution_m) and self.resolution_m > 0.0):
            raise ValueError(f"resolution_m must be positive, got {self.resolution_m}")
        if not (math.isfinite(self.origin_x_m) and math.isfinite(self.origin_y_m)):
            raise ValueError("origin must be finite")
        if min(self.shape) < 1:
            raise ValueError(f"shape must be at least 1 x 1, got {self.shape}")
        # Whole numbers and NumPy's are written otherwise than what comes back from disk: one map had two digests.
        for name in ("resolution_m", "origin_x_m", "origin_y_m"):
            object.__setattr__(self, name, float(getattr(self, name)))

    @property
    def rows(self) -> int:
        """How many rows there are: cells along map y."""
        return self.shape[0]

    @property
    def cols(self) -> int:
        """Number of columns."""
        return self.shape[1]

    def cell_at(self, x_m: float, y_m: float) -> tuple[int, int]:
        """Return the cell holding a map-frame point, inside the grid or not.

        >>> GridSpec(0.5, -1.0, 0.0, (4, 4)).cell_at(-0.9, 0.6)
        (1, 0)
        """
        row = math.floor((y_m - self.origin_y_m) / self.resolution_m)
        col = math.floor((x_m - self.origin_x_m) / self.resolution_m)
        return row, col

    def contains(self, row: int, col: int) -> bool:
        """Return whether a cell lies in the grid."""
        return 0 <= row < self.rows and 0 <= col < self.cols

    def centre_of(self, row: float, col: float) -> tuple[float, float]:
        """Return the map-frame centre ``(x_m, y_m)`` of a cell; fractional cells are welcome.

        >>> GridSpec(0.5, -1.0, 0.0, (4, 4)).centre_of(1, 0)
        (-0.75, 0.75)
        """
        return (
            self.origin_x_m + (col + 0.5) * self.resolution_m,
            self.origin_y_m + (row + 0.5) * self.resolution_m,
        )

    def positions_at(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return map-frame points ``float64[n, 2]`` as ``(x, y)`` in cells, ``float64[n, 2]`` as ``(row, col)``."""
        origin = np.array([self.origin_x_m, self.origin_y_m])
        positions: NDArray[np.float64] = ((points_m - origin) / self.resolution_m)[:, ::-1]
        return positions

    def flat_at(self, points_m: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return flat indices ``row * cols + col`` of map-frame points, -1 for those outside the grid."""
        # First, for a point that is far enough away has no whole number of a cell.
        positions = np.clip(self.positions_at(points_m), -1.0, np.array(self.shape))
        rows, cols = np.floor(positions).astype(np.intp).T
        inside = (rows >= 0) & (rows < self.rows) & (cols >= 0) & (cols < self.cols)
        return np.where(inside, rows * self.cols + cols, -1)
