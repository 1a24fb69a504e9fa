"""The map that localization works on: every cell is free or it is not ([BrownDonald2000]_ sec. 3.2)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid

FREE_MAX = 127
"""Greatest value of a cell that counts as free; so a cell without evidence counts as occupied."""


@dataclass(frozen=True, slots=True, eq=False)
class BinaryMap:
    """Obstacles and unknown cells against free ones. Whatever lies outside the grid is unknown, hence occupied."""

    spec: GridSpec
    occupied: NDArray[np.bool_]
    """``bool[rows, cols]``."""

    def __post_init__(self) -> None:
        """Refuse cells that do not fit the placement."""
        if self.occupied.shape != self.spec.shape or self.occupied.dtype != np.bool_:
            raise ValueError(
                f"expected bool{list(self.spec.shape)}, got {self.occupied.dtype}{list(self.occupied.shape)}"
            )

    @classmethod
    def from_grid(cls, grid: OccupancyGrid) -> "BinaryMap":
        """Return the map of an occupancy grid as it is now: occupied where the value exceeds 127."""
        return cls(grid.spec, grid.cells > FREE_MAX)
