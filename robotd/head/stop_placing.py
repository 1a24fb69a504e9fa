"""A stop placed on a map in the making: laid in where it was taken, or the whole map made again of moved stops."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import MissionError
from robotd.core.grid_spec import GridSpec
from robotd.core.map_stop import MapStop
from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.core.reading import Sweep, Tilt
from robotd.grid.latest import latest_with
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.window import CellWindow
from robotd.head.held import Held, Layer
from robotd.localization.settings import LocalizationSettings
from robotd.slam.local_map import LocalMaps
from robotd.slam.survey import Decision, Reconciled, Survey, SurveySettings


@dataclass(frozen=True, slots=True, eq=False)
class MapWithStop:
    """The next generation of a map, and how it came to be."""

    held: Held
    cells: NDArray[np.intp]
    """Those that changed, as flat indices, ascending."""
    decisions: tuple[Decision, ...]
    """The first says what came of placing the stop; none of the first stop of all."""
    map_from_robot: Pose2
    """Where the stop is in the end."""


def with_stop(
    held: Held,
    sweep: Sweep,
    travel: Travel,
    at: Pose2,
    localization: LocalizationSettings,
    *,
    found_again: bool = False,
) -> MapWithStop:
    """Return a map with one more stop; ``held`` stays as it is.

    Args:
        held: the map; a survey of it begins with its first stop.
        sweep: what was seen there.
        travel: since the stop before.
        at: where the stop is, if it is the first or ``found_again``.
        localization: how sweeps are sought.
        found_again: whether that was found by other means than wheels.

    Raises:
        MissionError: the map was stored without its stops.
    """
    readings = Readings.of(sweep.measured)
    decisions: tuple[Decision, ...] = ()
    before = held.survey or _resumed(held, localization)
    if before is None:
        survey = Survey.begun(readings, at, _settings(held, localization))
    else:
        survey, decisions = before.stepped(readings, before.found_at(at, travel) if found_again else travel)
    pose = survey.graph.pose(len(survey.graph.stops) - 1)
    # Stops have moved: a cell does not tell which stop said what, so nothing less than all of it will do.
    if any(isinstance(decision, Reconciled) for decision in decisions):
        made, cells = _made_again(held, sweep, survey)
    elif survey.graph.stops[-1].is_laid:
        made, cells = held.with_sweep(sweep, pose)
    else:
        made, cells = held, np.empty(0, np.intp)
    return MapWithStop(replace(made, survey=survey), cells, decisions, pose)


def _settings(held: Held, localization: LocalizationSettings) -> SurveySettings:
    return SurveySettings(maps=LocalMaps.of(held.grid.settings, localization))


def _resumed(held: Held, localization: LocalizationSettings) -> Survey | None:
    """Return the survey of a map that was stored; None of one that has just begun."""
    if held.stops is None:
        raise MissionError("this map was stored without its stops, and cannot be gone on with: make a new one")
    # With the misses: what a stop saw to be empty speaks against a wrong loop as well.
    stops = [(Readings(stop.beams(misses=True)), stop.map_from_robot) for stop in held.stops.stops]
    return Survey.resumed(stops, _settings(held, localization)) if stops else None


def _made_again(held: Held, sweep: Sweep, survey: Survey) -> tuple[Held, NDArray[np.intp]]:
    """Return the map made of all its stops where they are now, and the cells that differ."""
    assert held.stops is not None  # a map that is surveyed began with none, and keeps them
    graph = survey.graph
    stops = held.stops.stops
    if graph.stops[-1].is_laid:
        stops = (*stops, MapStop.of(sweep, graph.pose(len(graph.stops) - 1)))
    moved = tuple(
        replace(stop, map_from_robot=graph.pose(at)) for stop, at in zip(stops, graph.laid.tolist(), strict=True)
    )
    of_stops = MapStops(held.stops.settings, moved, held.stops.arithmetic)
    grid, latest = _laid(of_stops, held.grid.spec)
    cells = np.flatnonzero(grid.cells != held.grid.cells)
    changed = held.changed.joined(CellWindow.bounding(cells, grid.spec.shape))
    layers = tuple(_layer_of(of_stops, tilt, held) for tilt in of_stops.tilts)
    return Held(grid, grid.digest(), of_stops, latest, held.ready, changed, layers=layers), cells


def _laid(stops: MapStops, spec: GridSpec) -> tuple[OccupancyGrid, NDArray[np.uint8]]:
    """Return the grid that stops make, and what the latest sweep that met each cell said of it."""
    # In the order of the stops, as they were laid in: cells saturate, so another order gives another map.
    grid, latest = stops.grid_on(spec), np.zeros(spec.shape, np.uint8)
    for stop in stops.stops:
        latest = latest_with(latest, grid.usable(stop.sweep), stop.map_from_robot, spec)
    return grid, latest


def _layer_of(stops: MapStops, tilt: Tilt, held: Held) -> Layer:
    of_layer = stops.layer(tilt.tilt_rad)
    grid, latest = _laid(of_layer, held.grid.spec)
    return Layer(tilt, Held(grid, grid.digest(), of_layer, latest))
