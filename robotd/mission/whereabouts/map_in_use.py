"""The map the robot lives on now, and how much of it is on the disk."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotd.contract.events import MapChanged
from robotd.contract.ways import Point
from robotd.core.grid_spec import GridSpec
from robotd.core.reading import Tilt
from robotd.exploring.errand import Errand
from robotd.head.jobs import HeldMap, Inserted, MapRef

_NO_CELLS: NDArray[np.intp] = np.empty(0, dtype=np.intp)
_NO_VALUES: NDArray[np.uint8] = np.empty(0, dtype=np.uint8)


class MapState(NamedTuple):
    """How often a map has changed since it came into use; a later state is greater."""

    generation: int = 0
    """Of its cells."""
    remarks: int = 0
    """What is known of it beside them."""


@dataclass(slots=True)
class MapInUse:
    """One map: which one, how often it changed, and what of it is on the disk.

    Its cells are where array work is done, under its number. Where the robot is on it is another matter, see
    :class:`robotd.mission.whereabouts.whereabouts.Whereabouts`.
    """

    map_id: str
    """Digest of its content when it was loaded or begun."""
    name: str
    number: int
    """By which it is asked for."""
    begun: HeldMap
    """As it came into use."""
    digest: str = field(init=False)
    """Of the map as it is now."""
    stops: int | None = field(init=False)
    """How many stops it is made of by now; None if that is not known, as of maps that did not keep them."""
    tilts: tuple[Tilt, ...] = field(init=False)
    """Further ones at which each of its stops is looked round, each for a layer."""
    generation: int = 0
    """Counts its changes since it came into use."""
    remarks: int = 0
    """Counts what was remarked beside its cells since then."""
    settled: MapState = MapState()  # noqa: RUF009  # it is never changed
    """As which somebody saved it, or gave it up; less than any if it came into use unsaved."""
    in_store: MapState = MapState()  # noqa: RUF009  # as above
    """As which it was kept in the store, though unsaved."""
    kept_version: int | None = None
    """Which version of its name that is."""
    bumps_m: tuple[Point, ...] = ()
    """Where the robot bumped into something: an obstacle, whatever the laser sees there."""
    errand: Errand | None = None
    """How far exploring it has come; None if it was never explored."""

    def __post_init__(self) -> None:
        """Begin as it came."""
        self.digest, self.stops, self.tilts = self.begun.digest, self.begun.stops, self.begun.tilts

    @property
    def spec(self) -> GridSpec:
        """Where its cells lie."""
        return self.begun.spec

    @property
    def ref(self) -> MapRef:
        """What it is asked for by, as it is now."""
        return MapRef(self.number, self.generation)

    @property
    def state(self) -> MapState:
        """How often it has changed by now."""
        return MapState(self.generation, self.remarks)

    @property
    def is_unsaved(self) -> bool:
        """Whether it has changes that nobody saved."""
        return self.state > self.settled

    @property
    def is_at_risk(self) -> bool:
        """Whether changes of it are in memory alone."""
        return self.state > max(self.settled, self.in_store)

    @property
    def kept_beside(self) -> tuple[str, int] | None:
        """Name and version as which it is in the store, though unsaved: as it is, or as it was some stops ago."""
        return None if self.kept_version is None else (self.name, self.kept_version)

    @property
    def kept_as(self) -> int | None:
        """The version as which all that nobody saved is kept; None if some is not, or everything was saved."""
        return self.kept_version if self.is_unsaved and not self.is_at_risk else None

    def saved(self, state: MapState) -> None:
        """Take note that somebody saved it as it was then."""
        # It may have been given up, as it was later still, while the disk wrote.
        self.settled = max(self.settled, state)
        self.kept_version = None  # what is saved took its place

    def given_up(self) -> None:
        """Take note that nobody wants what is not saved of it."""
        self.settled = self.state

    def kept(self, state: MapState, version: int) -> None:
        """Take note that it is in the store, though unsaved, as it was then."""
        self.in_store, self.kept_version = state, version

    def found_unsaved(self, version: int) -> None:
        """Take note that it came from a version of the store that nobody had saved."""
        self.settled, self.kept_version = MapState(-1), version

    def bumped(self, place_m: Point) -> None:
        """Take note of a place where the robot bumped into something."""
        self.bumps_m = (*self.bumps_m, place_m)
        self.remarks += 1

    def explored(self, errand: Errand) -> None:
        """Take note of how far exploring it has come."""
        if errand != self.errand:
            self.errand = errand
            self.remarks += 1

    def take(self, inserted: Inserted) -> None:
        """Go on with the map that a sweep was laid in."""
        self.digest, self.stops = inserted.digest, inserted.stops
        self.generation += 1

    def changes(self, time_ns: int, inserted: Inserted) -> MapChanged:
        """Return the event for what was inserted last."""
        cells = np.frombuffer(inserted.cells, "<i8").astype(np.intp, copy=False)
        values = np.frombuffer(inserted.values, np.uint8)
        return MapChanged(time_ns, self.map_id, self.generation, self.spec, False, cells, values, self.stops)

    def whole(self, time_ns: int) -> MapChanged:
        """Return the event that carries every cell, as it came into use."""
        return whole(time_ns, self.map_id, 0, self.begun)


def whole(time_ns: int, map_id: str, generation: int, shown: HeldMap) -> MapChanged:
    """Return the event that carries every cell of a map."""
    return MapChanged(
        *(time_ns, map_id, generation, shown.spec, True, _NO_CELLS, _NO_VALUES, shown.stops), packed=shown.packed
    )


def in_place_of(place: MapInUse | None) -> str:
    """Say in the log which map another one takes the place of."""
    return "" if place is None else f", in the place of {place.name} ({place.map_id}, changed {place.generation} times)"
