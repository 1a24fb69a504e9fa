"""Between a grid with its stops and the files of a stored map: made, and read with everything checked."""

import logging

import numpy as np

from robotd.core.errors import MapError
from robotd.core.grid_bytes import cell_bytes, cells_of
from robotd.grid.image import encode_pgm, trinary_from_cells
from robotd.grid.map_stops import MapStops
from robotd.grid.map_yaml import map_yaml
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.maps.stops_file import decode_stops, encode_stops
from robotd.maps.version_files import CELLS, IMAGE, MANIFEST, STOPS, YAML, Content

_log = logging.getLogger(__name__)


def content_of(grid: OccupancyGrid, stops: MapStops | None) -> tuple[Content, str | None]:
    """Return the files of a map, with its stops if they are known and come to its grid again.

    With others it could not be loaded, and the grid is what the robot goes by: why they are left out is said beside.
    """
    packed, why = None, None
    if stops is not None:
        try:
            packed = encode_stops(stops)
            _check_derived(stops, grid)
        except MapError as error:
            packed, why = None, str(error)
    files: dict[str, bytes] = {
        CELLS: bytes(cell_bytes(grid.cells)),
        **({} if packed is None else {STOPS: packed}),
        IMAGE: bytes(encode_pgm(trinary_from_cells(grid.cells))),
        YAML: map_yaml(IMAGE, grid.spec).encode(),
    }
    count = None if stops is None or packed is None else len(stops.stops)
    return Content(grid.spec, grid.digest(), files, count), why


def map_of(content: Content, settings: GridSettings | None) -> tuple[OccupancyGrid, MapStops | None]:
    """Return the grid of a stored map, and what it was made of, if that is known.

    Args:
        content: its files, of which the checksums are right.
        settings: how further readings change a map that does not say itself how they did so far.

    Raises:
        MapError: they contradict each other; says which file.
    """
    stops = None if content.stops is None else _stops_of(content.files[STOPS], content.stops)
    # A map with stops goes on by the settings that it was made with, or it would not come to its stops again.
    grid = _grid_of(content, settings if stops is None else stops.settings)
    if stops is not None:
        _check_derived(stops, grid)
    return grid, stops


def _stops_of(data: bytes, expected: int) -> MapStops:
    try:
        stops = decode_stops(data)
    except MapError as error:
        raise MapError(f"{STOPS}: {error}") from error
    if len(stops.stops) != expected:
        raise MapError(f"{STOPS} has {len(stops.stops)} stops, {MANIFEST} says {expected}")
    return stops


def _check_derived(stops: MapStops, grid: OccupancyGrid) -> None:
    """Refuse stops that make another grid; if another arithmetic laid them in, the grid stands as it was made."""
    derived = stops.grid_on(grid.spec)
    others = int(np.count_nonzero(derived.cells != grid.cells))
    if not others:
        return
    if stops.is_of_this_arithmetic:
        raise MapError(f"{STOPS} does not make this map: {others} of {grid.cells.size} cells come out otherwise")
    _log.info(
        "this machine's arithmetic would draw %d of %d cells otherwise than that of the map's maker",
        others,
        grid.cells.size,
    )


def _grid_of(content: Content, settings: GridSettings | None) -> OccupancyGrid:
    try:
        cells = cells_of(content.files[CELLS], content.spec)
    except ValueError as error:
        raise MapError(f"{CELLS} has {error}") from error
    grid = OccupancyGrid(content.spec, cells, settings)
    # The checksums say that no byte was altered; this, that these cells belong to this placement.
    if grid.digest() != content.digest:
        raise MapError(f"{MANIFEST} has another digest than the map")
    return grid
