"""A map grown by several error radii, one for each level of readings: the farther the head, the larger the radius.

Whether a reading is feasible depends on its own radius alone, so rnk over all readings is the sum of rnk over each
level, on the map of that level (:mod:`robotd.grid.error_radii`).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.error_radii import ErrorRadii
from robotd.grid.readings import Readings
from robotd.grid.ternary import TernaryMap
from robotd.grid.window import CellWindow
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.obstacles.unknown_cells import UnknownCells


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """One map, prepared once for each level; only what is grown differs."""

    radii: ErrorRadii
    maps: tuple[PreparedMap, ...]
    """As many as there are radii."""

    @classmethod
    def of(cls, obstacles: Obstacles, spec: GridSpec, error_radius_cells: float) -> "Levels":
        """Return the paper's single level: one error radius for all readings, by which obstacles were grown."""
        return cls(ErrorRadii((error_radius_cells,)), (PreparedMap.of(obstacles, spec, error_radius_cells),))

    @classmethod
    def of_map(
        cls,
        ternary: TernaryMap,
        unknown: UnknownCells,
        radii: ErrorRadii,
        *,
        blocked_by: int,
        before_cores: NDArray[np.bool_] | None = None,
    ) -> "Levels":
        """Read and prepare a three-valued map; arguments as of :meth:`.Obstacles.of_map`. O(cells x levels)."""
        # One rim for all levels: heads of each are counted in the same cells. Along a row a disk reaches whole cells.
        rim = 0 if unknown is UnknownCells.OCCUPIED else int(radii.greatest)

        def prepared(radius_cells: float) -> PreparedMap:
            obstacles = Obstacles.of_map(
                ternary, unknown, radius_cells, blocked_by=blocked_by, before_cores=before_cores, rim=rim
            )
            return PreparedMap.of(obstacles, ternary.spec, radius_cells)

        return cls(radii, tuple(map(prepared, radii.cells)))

    def updated(
        self,
        ternary: TernaryMap,
        unknown: UnknownCells,
        changed: CellWindow,
        before_cores: NDArray[np.bool_] | None = None,
    ) -> "Levels":
        """Return the levels of a map that differs in a window alone; these stay as they are."""
        return Levels(self.radii, tuple(one.changed(ternary, unknown, changed, before_cores) for one in self.maps))

    @property
    def spec(self) -> GridSpec:
        """Where the cells lie."""
        return self.maps[0].spec

    @property
    def obstacles(self) -> Obstacles:
        """Those of the first level: where the robot may stand and what stops a beam are the same on all."""
        return self.maps[0].obstacles

    def reach(self, changed: CellWindow) -> CellWindow:
        """Return the window in which obstacles may differ, counted with their rim, after a change of the map."""
        # A disk reaches whole cells along a row or a column, so rounding its radius down loses none of them.
        return changed.moved(self.obstacles.rim).grown(int(self.radii.greatest), self.obstacles.free.shape)

    def parted(self, readings: Readings) -> Iterator[tuple[PreparedMap, NDArray[np.intp]]]:
        """Yield the map of each level that has a reading, and which readings they are, in order."""
        levels = self.radii.levels(readings.range_m / self.spec.resolution_m)
        for level, prepared in enumerate(self.maps):
            which = np.flatnonzero(levels == level)
            if len(which):
                yield prepared, which
