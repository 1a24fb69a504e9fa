"""Putting a sweep into the occupancy grid: what the kernel does."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.tables import UpdateTable


class InsertKernel(Protocol):
    """Putting a sweep into the occupancy grid."""

    def insert_sweep(
        self,
        cells: NDArray[np.uint8],
        readings: NDArray[np.float64],
        map_from_robot: Pose2,
        spec: GridSpec,
        tables: tuple[UpdateTable, UpdateTable],
        *,
        at_once: bool,
        between: NDArray[np.float64] | None = None,
    ) -> NDArray[np.intp]:
        """Change cells by two tables: those that beams run through, and those they end in.

        Args:
            cells: ``uint8[rows, cols]``, changed in place.
            readings: ``float64[n, 5]``, the rows of :class:`~robotd.grid.readings.Readings`.
            map_from_robot: where the robot stood.
            spec: where the cells are.
            tables: for cells that a beam runs through, and for the one that it ends in, which is not one of them.
            at_once: change each cell at most once, a hit beats all misses; else one beam after the other.
            between: ``float64[n, 5]``, beams that nobody measured, all of them misses: after the readings they change
                the cells that no beam has met, and no others; see :mod:`robotd.grid.between`.

        Returns:
            Flat indices of the cells whose value changed, ascending. O(beams x cells a beam).
        """
