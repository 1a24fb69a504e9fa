"""The map the robot lives on now, and where odometry lies on it."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from robotd.contract.events import MapChanged
from robotd.core.map_stop import MapStop
from robotd.core.pose import Odometry, Pose2
from robotd.core.reading import Sweep
from robotd.grid.binary import BinaryMap
from robotd.grid.latest import latest_with
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.window import CellWindow
from robotd.mission.whereabouts.readiness import Readiness

_NO_CELLS: NDArray[np.intp] = np.empty(0, dtype=np.intp)


@dataclass(frozen=True, slots=True, eq=False)
class Laid:
    """A grid with one more sweep in it."""

    grid: OccupancyGrid
    cells: NDArray[np.intp]
    """Those that changed, as flat indices, ascending."""
    latest: NDArray[np.uint8]
    """As :attr:`MapInUse.latest`, of this grid."""
    digest: str
    """Of the grid."""
    stops: MapStops | None
    """What the grid is made of, if that is known."""


@dataclass(slots=True)
class MapInUse:
    """One map and its ties; the supervisor has one at a time.

    The grid is never changed, only replaced, and on the loop: whoever holds one, on whatever thread, holds a snapshot.
    """

    map_id: str
    """Digest of its content when it was loaded or begun."""
    name: str
    grid: OccupancyGrid
    map_from_odom: Pose2 | None
    """Where the odometry frame lies on the map; None while nothing ties them."""
    digest: str = ""
    """Of the grid as it is now; made where the grid was, since for the largest it takes a tenth of a second."""
    stops: MapStops | None = None
    """What the grid is made of; None if that is not known, as of maps that did not keep it. Replaced with the grid."""
    generation: int = 0
    """Counts its changes since it came into use."""
    readiness: Readiness = field(default_factory=Readiness)
    """What localization has made of it."""
    latest: NDArray[np.uint8] = field(init=False)
    """``uint8[rows, cols]``: what the latest sweep that met each cell said of it, of those laid in since this map came
    into use; what was seen before is in the grid alone. Never changed, only replaced."""
    settled_generation: int = 0
    """The change up to which it is as somebody saved it, or gave it up; -1 if it came into use unsaved."""
    kept_generation: int = 0
    """The change up to which it is in the store, though unsaved."""
    kept_version: int | None = None
    """Which version of its name that is."""
    is_doubted: bool = False
    """Whether the tie is no longer believed: a robot that looked and did not find itself, or was out of sight of
    its wheels, does not know where it is, though it may still know which way it looks."""

    def __post_init__(self) -> None:
        """Make the digest, unless somebody did; nothing was said of any cell yet."""
        self.digest = self.digest or self.grid.digest()
        self.latest = np.zeros(
            self.grid.spec.shape, np.uint8
        )  # NOTHING, and not touched: that would take long on the loop

    @property
    def is_unsaved(self) -> bool:
        """Whether it has changes that nobody saved."""
        return self.generation > self.settled_generation

    @property
    def is_at_risk(self) -> bool:
        """Whether it has changes that are in memory alone."""
        return self.generation > max(self.settled_generation, self.kept_generation)

    @property
    def kept_as(self) -> int | None:
        """The version as which all that nobody saved is kept; None if some is not, or everything was saved."""
        return self.kept_version if self.is_unsaved and not self.is_at_risk else None

    def pose_of(self, odometry: Odometry) -> Pose2 | None:
        """Return where odometry places the robot on the map, if anything ties them that is believed."""
        return None if self.map_from_odom is None or self.is_doubted else self.map_from_odom @ odometry.in_odom

    def heading_of(self, odometry: Odometry) -> float | None:
        """Return the robot's heading in the map frame [rad], if anything ever tied odometry to the map."""
        return None if self.map_from_odom is None else (self.map_from_odom @ odometry.in_odom).heading_rad

    def tie(self, map_from_robot: Pose2, in_odom: Pose2) -> None:
        """Note that the robot was at ``map_from_robot`` when odometry placed it at ``in_odom``."""
        self.map_from_odom = map_from_robot @ in_odom.inverse()
        self.is_doubted = False

    def grid_with(self, sweep: Sweep) -> "Laid":
        """Return the grid with a sweep laid in where odometry places it.

        Raises:
            ValueError: nothing ties odometry to the map.
        """
        if self.map_from_odom is None:
            raise ValueError("a sweep cannot be inserted: odometry is not tied to the map")
        grid = OccupancyGrid(self.grid.spec, self.grid.cells, self.grid.settings)
        map_from_robot = self.map_from_odom @ sweep.in_odom
        changed = grid.insert(sweep, map_from_robot)
        latest = latest_with(self.latest, grid.usable(sweep), map_from_robot, grid.spec)
        stops = None if self.stops is None else self.stops.with_stop(MapStop(sweep, map_from_robot))
        return Laid(grid, changed, latest, grid.digest(), stops)

    def take(self, laid: "Laid") -> None:
        """Go on with the grid that a sweep was laid in."""
        self.grid, self.latest, self.digest, self.stops = laid.grid, laid.latest, laid.digest, laid.stops
        self.generation += 1
        self.readiness.note(CellWindow.bounding(laid.cells, laid.grid.spec.shape))

    def changes(self, time_ns: int, cells: NDArray[np.intp]) -> MapChanged:
        """Return the event for these changed cells."""
        values, stops = self.grid.cells.reshape(-1)[cells], None if self.stops is None else len(self.stops.stops)
        return MapChanged(time_ns, self.map_id, self.generation, self.grid.spec, False, cells, values, stops)

    def whole(self, time_ns: int) -> MapChanged:
        """Return the event that carries every cell."""
        event = self.changes(time_ns, _NO_CELLS)
        return replace(event, whole=True, values=self.grid.cells)

    def binary(self) -> BinaryMap:
        """Return the thresholded map."""
        return BinaryMap.from_grid(self.grid)


def in_place_of(place: MapInUse | None) -> str:
    """Say in the log which map another one takes the place of."""
    return "" if place is None else f", in the place of {place.name} ({place.map_id}, changed {place.generation} times)"
