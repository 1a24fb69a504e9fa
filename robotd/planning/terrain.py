"""Where the robot may be on a map, seen from where it stands, and how it gets out of a place where it does not fit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.ways import Point
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.planning.distance_field import distance_field
from robotd.planning.line_of_sight import Cell, Position, centre_of, distances_of_leg, in_sight
from robotd.planning.settings import PlanningSettings
from robotd.planning.traversable import free_cells, inflated


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """Where the robot may be."""

    free: NDArray[np.bool_]
    """``bool[rows, cols]``: no obstacle as far as anybody knows, or under the robot."""
    met: NDArray[np.bool_]
    """``bool[rows, cols]``: an obstacle that a beam met; the others that are not free were never seen."""
    allowed: NDArray[np.bool_]
    """``bool[rows, cols]``: the robot fits."""
    start: Position
    robot_cells: float
    """Radius of its disk."""
    reach_cells: float
    """How far to look for a way out of a place where it does not fit."""

    @classmethod
    def of(
        cls,
        grid: OccupancyGrid,
        start: Pose2,
        hit: NDArray[np.bool_],
        doubted: NDArray[np.bool_] | None,
        settings: PlanningSettings,
    ) -> "Terrain":
        """Return the terrain of a map.

        Args:
            grid: the map.
            start: where the robot stands, map frame.
            hit: ``bool[rows, cols]``, cells that are obstacles whatever the grid says of them.
            doubted: ``bool[rows, cols]``, cells that count as never seen; None for none.
            settings: the robot.
        """
        resolution_m, here = grid.spec.resolution_m, grid.spec.cell_at(start.x_m, start.y_m)
        robot_cells, clearance_cells = settings.robot_radius_m / resolution_m, settings.clearance_m / resolution_m
        taken = hit if doubted is None else hit & ~doubted
        free = free_cells(grid, settings.gap_cells, doubted) & ~taken
        met = (grid.cells > NO_INFORMATION) | taken
        rows, cols = np.ogrid[: free.shape[0], : free.shape[1]]
        # Where it stands it fits, whatever the map says: a wrong range under the robot must not keep it there
        # for ever.
        free |= (rows - here[0]) ** 2 + (cols - here[1]) ** 2 <= robot_cells**2
        allowed = ~inflated(~free, robot_cells, clearance_cells)
        reach_cells = 2.0 * (robot_cells + max(clearance_cells, 1.0))
        return cls(free, met & ~free, allowed, position(grid.spec, (start.x_m, start.y_m)), robot_cells, reach_cells)

    def ways_from(self, here: Cell) -> NDArray[np.float64]:
        """Return how long the way is from where the robot stands to each cell, ``float64[rows, cols]`` in cells.

        ``inf`` where none leads; what it takes to get out of a place where it does not fit is left out.
        """
        # A field of zeros, for where to is not asked: only whether it gets onto any terrain on which it fits.
        start = self.way_out(here, np.zeros(self.allowed.shape))
        return np.full(self.allowed.shape, np.inf) if start is None else distance_field(self.allowed, start)

    def way_out(self, here: Cell, field: NDArray[np.float64]) -> Cell | None:
        """Return where to start on the field: here, or the nearest cell that can be reached on which the robot fits."""
        if self.allowed[here]:
            return here if np.isfinite(field[here]) else None
        cells = np.argwhere(self.allowed & np.isfinite(field))
        distances = np.hypot(*(cells - here).T)
        near = distances <= self.reach_cells
        around = np.argwhere(self.met)
        # Nothing farther can come within the robot's radius on a leg so short; two cells are for the size of the cells
        # themselves.
        around = around[np.hypot(*(around - here).T) <= self.reach_cells + self.robot_cells + 2.0]
        # Stable: of several cells at one distance every replay must take the same one.
        for row, col in cells[near][np.argsort(distances[near], kind="stable")].tolist():
            if self._gets_out(around, (row, col)):
                return row, col
        return None

    def _gets_out(self, around: NDArray[np.intp], to: Cell) -> bool:
        """Whether on a straight leg from the start the robot meets no obstacle, and none it met before comes nearer.

        Never seen is what lies round a robot that has just begun: its middle must keep to what is free, no more.
        """
        if not in_sight(self.free, self.start, centre_of(to)):
            return False
        at_first = distances_of_leg(around, self.start, self.start)
        on_the_way = distances_of_leg(around, self.start, centre_of(to))
        # No nearer than it is now: a leg that leads past the obstacle it stands at is no way out.
        return bool((on_the_way >= np.minimum(at_first, self.robot_cells) - 1e-9).all())


def position(spec: GridSpec, point_m: Point) -> Position:
    """Return a map-frame point as ``(row, col)`` in cells."""
    row, col = spec.positions_at(np.array([point_m]))[0].tolist()
    return row, col
