"""A map as it is held where the work is done: a snapshot, of which an insertion makes the next."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_bytes import packed_cells
from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.core.reading import Sweep
from robotd.grid.latest import HIT, latest_with
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.window import CellWindow
from robotd.head.jobs import HeldMap
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings
from robotd.slam.survey import Survey

_NOTHING = CellWindow(0, 0, 0, 0)


@dataclass(frozen=True, slots=True, eq=False)
class Held:
    """One generation of a map. Never changed, so the ones before and after it may share what it is made of."""

    grid: OccupancyGrid
    digest: str
    """Of the grid."""
    stops: MapStops | None
    """What the grid is made of; None if that is not known, as of maps that did not keep it."""
    latest: NDArray[np.uint8]
    """``uint8[rows, cols]``: what the latest sweep that met each cell said of it, of those laid in since this map came
    to be held; what was seen before is in the grid alone."""
    ready: ReadyMap | None = None
    """What localization made of this generation, or of one before it: a changed map is not made ready from nothing."""
    changed: CellWindow = _NOTHING
    """Where the grid changed since that one."""
    survey: Survey | None = None
    """What is known of its stops together, if they were placed one after the other."""

    @classmethod
    def of(cls, grid: OccupancyGrid, stops: MapStops | None) -> "Held":
        """Return a map of which no sweep was laid in here."""
        return cls(grid, grid.digest(), stops, np.zeros(grid.spec.shape, np.uint8))

    @property
    def told(self) -> HeldMap:
        """What is told of it."""
        stops = None if self.stops is None else len(self.stops.stops)
        return HeldMap(self.grid.spec, self.digest, packed_cells(self.grid.cells), stops, self.grid.settings)

    def obstacles(self, met_m: Sequence[tuple[float, float]] = ()) -> NDArray[np.bool_]:
        """Return the cells that are obstacles whatever their value, ``bool[rows, cols]``: hit last, or met there."""
        # One beam is enough (decision 20).
        hit: NDArray[np.bool_] = self.latest == HIT
        cells = self.grid.spec.flat_at(np.array(met_m).reshape(-1, 2))
        hit.reshape(-1)[cells[cells >= 0]] = True
        return hit

    def with_sweep(self, sweep: Sweep, map_from_robot: Pose2) -> tuple["Held", NDArray[np.intp]]:
        """Return the map with a sweep laid in that was taken at ``map_from_robot``, and the cells that it changed.

        Those are flat indices, ascending; this map stays as it is.
        """
        # A copy: who holds the generation before must find it as it was.
        grid = OccupancyGrid(self.grid.spec, self.grid.cells, self.grid.settings)
        cells = grid.insert(sweep, map_from_robot)
        latest = latest_with(self.latest, grid.usable(sweep), map_from_robot, grid.spec)
        stops = None if self.stops is None else self.stops.with_stop(MapStop.of(sweep, map_from_robot))
        # Joined with what changed before: what is ready may be some generations old.
        changed = self.changed.joined(CellWindow.bounding(cells, grid.spec.shape))
        return Held(grid, grid.digest(), stops, latest, self.ready, changed), cells

    def made_ready(self, settings: LocalizationSettings, errors: ErrorModel) -> tuple["Held", ReadyMap]:
        """Return it with what localization works on: made from nothing, or from what was ready and where it changed."""
        if self.ready is None:
            ready = ReadyMap.of(self.grid, settings, errors)
        else:
            ready = self.ready.updated(self.grid, self.changed)
        return replace(self, ready=ready, changed=_NOTHING), ready
