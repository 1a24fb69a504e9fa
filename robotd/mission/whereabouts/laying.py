"""Laying a sweep into a grid: a snapshot in, another out, so that the worker never sees the map in use."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.core.reading import Sweep
from robotd.grid.latest import latest_with
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid


@dataclass(frozen=True, slots=True, eq=False)
class Laid:
    """A grid with one more sweep in it."""

    grid: OccupancyGrid
    cells: NDArray[np.intp]
    """Those that changed, as flat indices, ascending."""
    latest: NDArray[np.uint8]
    """As :attr:`.MapInUse.latest`, of this grid."""
    digest: str
    """Of the grid."""
    stops: MapStops | None
    """What the grid is made of, if that is known."""


def lay(
    grid: OccupancyGrid, latest: NDArray[np.uint8], stops: MapStops | None, sweep: Sweep, map_from_robot: Pose2
) -> Laid:
    """Return the grid with a sweep laid in that was taken at ``map_from_robot``; what is given stays as it is.

    Args:
        grid: what was known before.
        latest: ``uint8[rows, cols]``, as :attr:`.MapInUse.latest`.
        stops: what the grid is made of; None if that is not known, and then it stays unknown.
        sweep: what was seen.
        map_from_robot: where the sweep began.
    """
    copy = OccupancyGrid(grid.spec, grid.cells, grid.settings)
    changed = copy.insert(sweep, map_from_robot)
    said = latest_with(latest, copy.usable(sweep), map_from_robot, copy.spec)
    further = None if stops is None else stops.with_stop(MapStop.of(sweep, map_from_robot))
    return Laid(copy, changed, said, copy.digest(), further)
