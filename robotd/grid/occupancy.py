"""The statistical occupancy grid: what the beams of all stops say about each cell ([BrownDonald2000]_ sec. 1, 3.2)."""

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_bytes import grid_digest
from robotd.core.grid_spec import GridSpec
from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid import kernels
from robotd.grid.between import between
from robotd.grid.readings import Readings
from robotd.grid.settings import BetweenBeams, GridSettings, OverRange, UpdatePolicy
from robotd.grid.tables import NO_INFORMATION, lower_table, raise_table


class OccupancyGrid:
    """8-bit cells, 0 surely vacant to 255 surely occupied, and the two tables that change them."""

    def __init__(
        self, spec: GridSpec, cells: NDArray[np.uint8] | None = None, settings: GridSettings | None = None
    ) -> None:
        """Start from nothing known, or from the cells of a stored map ``uint8[rows, cols]`` (copied).

        ``spec`` has the last word on size and resolution; ``settings`` on tables and policies.
        """
        if cells is not None and (cells.shape != spec.shape or cells.dtype != np.uint8):
            raise ValueError(f"expected uint8{list(spec.shape)}, got {cells.dtype}{list(cells.shape)}")
        self.spec = spec
        self.settings = settings or GridSettings()
        self.cells: NDArray[np.uint8] = (
            np.full(spec.shape, NO_INFORMATION, np.uint8) if cells is None else np.array(cells, np.uint8, order="C")
        )
        self._raise = raise_table(self.settings.raise_alpha)
        self._lower = lower_table(self.settings.lower_alpha)

    def insert(self, sweep: Sweep, map_from_robot: Pose2) -> NDArray[np.intp]:
        """Update the cells by the readings of a stop; what lies outside the grid is ignored.

        Args:
            sweep: the readings, in the robot frame.
            map_from_robot: where the robot stood.

        Returns:
            Flat indices ``row * cols + col`` of the cells whose value changed, ascending. O(readings x cells a beam).
        """
        return self.lay(Readings.of(self.usable(sweep)), map_from_robot)

    def lay_in(self, stop: MapStop) -> NDArray[np.intp]:
        """Update the cells by a stop as :meth:`insert` does by its sweep, without making that of it."""
        beams = stop.beams(misses=self.settings.over_range is OverRange.CLEAR)
        return self.lay(Readings(beams), stop.map_from_robot)

    def lay(self, readings: Readings, map_from_robot: Pose2) -> NDArray[np.intp]:
        """Update the cells as :meth:`insert` does, by readings of one stop that are columns already; all of them."""
        tables, at_once = (self._lower, self._raise), self.settings.policy is UpdatePolicy.PER_SWEEP
        is_filled = self.settings.between_beams is not BetweenBeams.UNSEEN
        return kernels.in_use().insert.insert_sweep(
            self.cells,
            readings.rows,
            map_from_robot,
            self.spec,
            tables,
            at_once=at_once,
            # Handed to the kernel with the sweep, not laid in after it: whether a cell was never seen is asked
            # before this sweep has met it.
            between=between(readings, self.spec.resolution_m).rows if is_filled else None,
        )

    def digest(self) -> str:
        """Return the SHA-256 of placement and cells, in hexadecimal: equal exactly if the maps are."""
        return grid_digest(self.spec, self.cells)

    def usable(self, sweep: Sweep) -> tuple[RangeReading, ...]:
        """Return the readings of a sweep that change this grid."""
        if self.settings.over_range is OverRange.CLEAR:
            return sweep.measured
        return tuple(reading for reading in sweep.measured if reading.status is ReadingStatus.OK)
