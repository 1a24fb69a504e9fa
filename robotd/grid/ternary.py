"""The map in three values: a cell was seen to be an obstacle, was seen to be vacant, or was never seen.

[BrownDonald2000]_ sec. 3.2 knows two, unknown cells being obstacles (:mod:`robotd.grid.binary`). What a reading says of
a cell that nobody has seen is for localization to choose, so the three are kept apart here.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.grid.window import CellWindow


@dataclass(frozen=True, slots=True, eq=False)
class TernaryMap:
    """Obstacles and vacant cells; what is neither is unknown, as is whatever lies outside the grid."""

    spec: GridSpec
    occupied: NDArray[np.bool_]
    """``bool[rows, cols]``: seen more as an obstacle than not."""
    vacant: NDArray[np.bool_]
    """``bool[rows, cols]``: seen more as vacant than not."""

    def __post_init__(self) -> None:
        """Refuse cells that do not fit the placement, or that are both."""
        for name, cells in (("occupied", self.occupied), ("vacant", self.vacant)):
            if cells.shape != self.spec.shape or cells.dtype != np.bool_:
                raise ValueError(f"{name}: expected bool{list(self.spec.shape)}, got {cells.dtype}{list(cells.shape)}")
        if (self.occupied & self.vacant).any():
            raise ValueError("a cell cannot be both occupied and vacant")

    @classmethod
    def from_grid(cls, grid: OccupancyGrid) -> "TernaryMap":
        """Return the map of an occupancy grid as it is now; only cells that were never updated are unknown."""
        return cls(grid.spec, grid.cells > NO_INFORMATION, grid.cells < NO_INFORMATION)

    def updated(self, grid: OccupancyGrid, changed: CellWindow) -> "TernaryMap":
        """Return the map of a grid that differs from the one this is of in a window alone; this one stays as it is."""
        # Copies: a thread may be localizing on this map (decision 11).
        occupied, vacant = self.occupied.copy(), self.vacant.copy()
        occupied[changed.slices] = grid.cells[changed.slices] > NO_INFORMATION
        vacant[changed.slices] = grid.cells[changed.slices] < NO_INFORMATION
        return TernaryMap(self.spec, occupied, vacant)

    @property
    def unknown(self) -> NDArray[np.bool_]:
        """The cells that nobody has seen, ``bool[rows, cols]``."""
        unknown: NDArray[np.bool_] = ~(self.occupied | self.vacant)
        return unknown
