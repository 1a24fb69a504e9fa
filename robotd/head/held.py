"""A map as it is held where the work is done: a snapshot, of which an insertion makes the next."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_bytes import packed_cells
from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.core.reading import Slant, Sweep, Tilt
from robotd.grid.latest import HIT, latest_with
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
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
    layers: tuple["Layer", ...] = ()
    """What was seen at further tilts, on the same cells, by tilt; this map alone says where its stops are."""

    @classmethod
    def of(cls, grid: OccupancyGrid, stops: MapStops | None) -> "Held":
        """Return a map of which no sweep was laid in here; its layers are made of its stops."""
        layers = tuple(
            Layer(tilt, cls.of(layer.grid_on(grid.spec), layer))
            for tilt, layer in (() if stops is None else ((tilt, stops.layer(tilt.tilt_rad)) for tilt in stops.tilts))
        )
        return cls(grid, grid.digest(), stops, np.zeros(grid.spec.shape, np.uint8), layers=layers)

    @property
    def told(self) -> HeldMap:
        """What is told of it."""
        stops = None if self.stops is None else len(self.stops.stops)
        packed = packed_cells(self.grid.cells)
        return HeldMap(self.grid.spec, self.digest, memoryview(packed), stops, self.grid.settings, self.tilts)

    @property
    def tilts(self) -> tuple[Tilt, ...]:
        """The tilts of its layers, ascending."""
        return tuple(layer.tilt for layer in self.layers)

    def obstacles(self, met_m: Sequence[tuple[float, float]] = ()) -> NDArray[np.bool_]:
        """Return the cells that are obstacles whatever their value, ``bool[rows, cols]``.

        What was hit last, what was met there, and what is an obstacle at any other height.
        """
        # One beam is enough (decision 20).
        hit: NDArray[np.bool_] = self.latest == HIT
        for layer in self.layers:
            hit |= layer.held.obstacles() | (layer.held.grid.cells > NO_INFORMATION)
        cells = self.grid.spec.flat_at(np.array(met_m).reshape(-1, 2))
        hit.reshape(-1)[cells[cells >= 0]] = True
        return hit

    def with_sweep(self, sweep: Sweep, map_from_robot: Pose2) -> tuple["Held", NDArray[np.intp]]:
        """Return the map with a sweep laid in that was taken at ``map_from_robot``, and the cells that it changed.

        Those are flat indices of its own grid, ascending; this map stays as it is.
        """
        # A copy: who holds the generation before must find it as it was.
        grid = OccupancyGrid(self.grid.spec, self.grid.cells, self.grid.settings)
        cells = grid.insert(sweep, map_from_robot)
        latest = latest_with(self.latest, grid.usable(sweep), map_from_robot, grid.spec)
        stops = None if self.stops is None else self.stops.with_stop(MapStop.of(sweep, map_from_robot))
        # Joined with what changed before: what is ready may be some generations old.
        changed = self.changed.joined(CellWindow.bounding(cells, grid.spec.shape))
        layers = {layer.tilt.tilt_rad: layer for layer in self.layers}
        for slant in sweep.slants:
            before = layers.get(slant.tilt.tilt_rad) or Layer(slant.tilt, self._blank())
            layers[slant.tilt.tilt_rad] = before.with_slant(sweep, slant, map_from_robot)
        in_order = tuple(layers[tilt_rad] for tilt_rad in sorted(layers))
        return Held(grid, grid.digest(), stops, latest, self.ready, changed, layers=in_order), cells

    def _blank(self) -> "Held":
        """Return a map of the same cells on which nothing is known."""
        settings = self.grid.settings
        return Held.of(OccupancyGrid(self.grid.spec, settings=settings), MapStops(settings))

    def made_ready(self, settings: LocalizationSettings, errors: ErrorModel) -> tuple["Held", ReadyMap]:
        """Return it with what localization works on: made from nothing, or from what was ready and where it changed."""
        if self.ready is None:
            ready = ReadyMap.of(self.grid, settings, errors)
        else:
            ready = self.ready.updated(self.grid, self.changed)
        return replace(self, ready=ready, changed=_NOTHING), ready

    def layers_ready(
        self, settings: LocalizationSettings, errors: ErrorModel
    ) -> tuple["Held", tuple[tuple[Tilt, ReadyMap], ...]]:
        """Return the same of its layers, each with its tilt."""
        made = [(layer.tilt, *layer.held.made_ready(settings, errors)) for layer in self.layers]
        held = replace(self, layers=tuple(Layer(tilt, held) for tilt, held, _ in made))
        return held, tuple((tilt, ready) for tilt, _, ready in made)


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """What a map is at a further tilt: a map of its own, with the stops of the other."""

    tilt: Tilt
    held: Held

    def with_slant(self, sweep: Sweep, slant: Slant, map_from_robot: Pose2) -> "Layer":
        """Return it with what a sweep saw at its tilt laid in."""
        return Layer(slant.tilt, self.held.with_sweep(sweep.at(slant), map_from_robot)[0])
