"""The map the robot lives on now, and how much of it is on the disk."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from robotd.contract.events import MapChanged
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.window import CellWindow
from robotd.mission.whereabouts.laying import Laid
from robotd.mission.whereabouts.readiness import Readiness

_NO_CELLS: NDArray[np.intp] = np.empty(0, dtype=np.intp)


@dataclass(slots=True)
class MapInUse:
    """One map: its cells, how often they changed, and what of it is on the disk.

    The grid is never changed, only replaced, and on the loop: who holds one, on any thread, holds a snapshot. Where the
    robot is on it is another matter, see :class:`robotd.mission.whereabouts.whereabouts.Whereabouts`.
    """

    map_id: str
    """Digest of its content when it was loaded or begun."""
    name: str
    grid: OccupancyGrid
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
    def at_risk(self) -> int:
        """How many of its changes are in memory alone."""
        return max(0, self.generation - max(self.settled_generation, self.kept_generation))

    @property
    def kept_beside(self) -> tuple[str, int] | None:
        """Name and version as which it is in the store, though unsaved: as it is, or as it was some stops ago."""
        return None if self.kept_version is None else (self.name, self.kept_version)

    @property
    def kept_as(self) -> int | None:
        """The version as which all that nobody saved is kept; None if some is not, or everything was saved."""
        return self.kept_version if self.is_unsaved and not self.at_risk else None

    def saved(self, generation: int) -> None:
        """Take note that somebody saved it as it was after that change."""
        # It may have been given up, as it was later still, while the disk wrote.
        self.settled_generation = max(self.settled_generation, generation)
        self.kept_version = None  # what is saved took its place

    def given_up(self) -> None:
        """Take note that nobody wants what is not saved of it."""
        self.settled_generation = self.generation

    def kept(self, generation: int, version: int) -> None:
        """Take note that it is in the store, though unsaved, as it was after that change."""
        self.kept_generation, self.kept_version = generation, version

    def found_unsaved(self, version: int) -> None:
        """Take note that it came from a version of the store that nobody had saved."""
        self.settled_generation, self.kept_version = -1, version

    def take(self, laid: Laid) -> None:
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


def in_place_of(place: MapInUse | None) -> str:
    """Say in the log which map another one takes the place of."""
    return "" if place is None else f", in the place of {place.name} ({place.map_id}, changed {place.generation} times)"
