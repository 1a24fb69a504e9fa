"""Maps of some stops, made when they are needed: a map of fifteen takes a millisecond, and is never out of date."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import BetweenBeams, GridSettings
from robotd.localization.placing import Ground
from robotd.localization.settings import LocalizationSettings
from robotd.slam.stop_graph import StopGraph


@dataclass(frozen=True, slots=True)
class LocalMaps:
    """How maps that sweeps are placed on are made of stops."""

    grid: GridSettings = field(
        default_factory=lambda: GridSettings(
            raise_alpha=0.5, lower_alpha=0.9, between_beams=BetweenBeams.UNSEEN, rows=1, cols=1
        )
    )
    """Gentle tables: a wall that one sweep grazed stays a wall."""
    reach_m: float = 20.0
    """So far round the place in question; what lies farther away is left out."""
    localization: LocalizationSettings = field(default_factory=LocalizationSettings)

    @classmethod
    def of(cls, of_map: GridSettings, localization: LocalizationSettings) -> "LocalMaps":
        """Return how local maps are made for a map of some settings: of cells of that size."""
        usual = cls()
        # Of fine cells a map as wide would be as large as any may be, at every stop.
        reach_m = min(usual.reach_m, _REACH_CELLS * of_map.resolution_m)
        return cls(replace(usual.grid, resolution_m=of_map.resolution_m), reach_m, localization)

    def ground(self, graph: StopGraph, which: Sequence[int] | NDArray[np.intp], around: Pose2) -> Ground:
        """Return the map that some stops make about a place."""
        laid = [(graph.stops[stop].readings, graph.pose(stop)) for stop in which]
        here = np.array([(around.x_m, around.y_m)])
        heads = np.concatenate([here, *(readings.heads_at(pose) for readings, pose in laid)])
        # One wrong range of 80 m would else make the map of fifteen stops as large as a building's.
        points = np.clip(heads, here - self.reach_m, here + self.reach_m)
        corners = [tuple(points.min(axis=0).tolist()), tuple(points.max(axis=0).tolist())]
        grid = OccupancyGrid(self.grid.spec_covering(corners, _MARGIN_M), settings=self.grid)
        for readings, pose in laid:
            grid.lay(readings, pose)
        return Ground(grid, self.localization)


_REACH_CELLS = 1000
_MARGIN_M = 0.5
"""Beyond the farthest head, so that none is at the edge."""
