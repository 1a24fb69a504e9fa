"""What a map says to who explores it: where the robot can go, what stops a beam, and what nobody has seen."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.ways import Point
from robotd.core.grid_spec import GridSpec
from robotd.core.rectangle import Rectangle
from robotd.exploring.outlook import Outlook
from robotd.exploring.settings import ExploringSettings
from robotd.grid.distance import distance_transform
from robotd.grid.footprints import dilate
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.planning.distance_field import distance_field
from robotd.planning.terrain import Terrain

_AROUND = np.ones((3, 3), np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class Charted:
    """What is known of a map when a choice is made."""

    spec: GridSpec
    free: NDArray[np.bool_]
    unknown: NDArray[np.bool_]
    allowed: NDArray[np.bool_]
    """``bool[rows, cols]``: the robot fits."""
    ways: NDArray[np.float64]
    """``float64[rows, cols]``: from the robot to each cell [cells]."""
    outlook: Outlook
    seen_m2: float

    @classmethod
    def of(
        cls,
        grid: OccupancyGrid,
        hit: NDArray[np.bool_],
        lone: NDArray[np.bool_],
        ground: Terrain,
        *,
        robot: Point,
        within: Rectangle | None,
        cut_off_m: float,
        settings: ExploringSettings,
    ) -> "Charted":
        """Return what is known of a map.

        Args:
            grid: the map.
            hit: ``bool[rows, cols]``, cells that are obstacles whatever the grid says of them.
            lone: ``bool[rows, cols]``, those of all obstacles that a single wrong range may have left.
            ground: where the robot may be.
            robot: where it stands, map frame.
            within: what is explored; None is all of the map.
            cut_off_m: farther than this nothing is seen.
            settings: how narrow nothing is an opening.
        """
        spec = grid.spec
        gap_cells = settings.opening_min_m / spec.resolution_m
        walls, unknown = _walls_and_unknown((grid.cells > NO_INFORMATION) | hit, lone, ground.free, gap_cells)
        return cls(
            spec,
            ground.free,
            unknown,
            ground.allowed,
            ground.ways_from(spec.cell_at(*robot)),
            Outlook.on(spec, walls, unknown, within, cut_off_m),
            float(ground.free.sum()) * spec.resolution_m**2,
        )

    def candidates(self, lattice_m: float) -> NDArray[np.intp]:
        """Return the cells of a lattice that the robot can go to and that lie within bounds, ``intp[n, 2]``."""
        step = max(1, round(lattice_m / self.spec.resolution_m))
        # A lattice of the grid and not of the bounds: the same candidates come up at each choice, so that what was
        # tried is recognized.
        cells = np.argwhere(np.isfinite(self.ways[::step, ::step])) * step
        points_m, within = self.points_m(cells), self.outlook.within
        low, high = (within.west_m, within.south_m), (within.east_m, within.north_m)
        inside: NDArray[np.bool_] = np.all((points_m >= low) & (points_m <= high), axis=1)
        return cells[inside]

    def points_m(self, cells: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the centres of cells, ``float64[n, 2]`` of x, y in the map frame."""
        origin = np.array((self.spec.origin_x_m, self.spec.origin_y_m))
        points: NDArray[np.float64] = origin + (cells[:, ::-1] + 0.5) * self.spec.resolution_m
        return points

    def ways_m(self, cells: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return how far it is from the robot to some cells, ``float64[n]``."""
        return self.ways[cells[:, 0], cells[:, 1]] * self.spec.resolution_m

    def ways_between_m(self, cells: NDArray[np.intp], which: int) -> NDArray[np.float64]:
        """Return how far it is from one of some cells to all of them, ``float64[n]``."""
        row, col = cells[which].tolist()
        field = distance_field(self.allowed, (row, col))
        return field[cells[:, 0], cells[:, 1]] * self.spec.resolution_m


def _walls_and_unknown(
    occupied: NDArray[np.bool_], lone: NDArray[np.bool_], free: NDArray[np.bool_], gap_cells: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return what stops a beam, and what nobody has seen, both ``bool[rows, cols]``.

    A wrong range in the air hides nothing. One hit on the border of the unseen is a wall: far from a stop beams lie
    apart, and a wall is a row of single hits. What is unseen between them and narrower than the gap, is wall as well.
    """
    unseen = ~free & ~occupied
    walls = occupied & ~(lone & ~dilate(unseen, _AROUND))
    beyond_gaps = distance_transform(walls) > gap_cells / 2.0
    walls |= unseen & (distance_transform(beyond_gaps) > gap_cells / 2.0)
    return walls, unseen & ~walls
