"""Maps of ROS's map_server (a picture and a yaml beside it) as occupancy grids, and back.

A grey means ``p = 1 - grey / 255``, the probability of an obstacle (``grey / 255`` where ``negate`` says so). A cell of
ours means ``p = value / 255``; 128 is a cell never seen. So ``value = 255 - grey``, and no evidence is lost:

- *trinary*: what lies between the thresholds is unknown; walls and free cells keep how sure they are.
- *scale*: every grey is kept; what can be seen through is unknown.
- *raw*: a pixel of 0 to 100 is the probability in per cent; any other is unknown.

Thresholds are compared with the quotient of whole numbers in double precision: map_server's 0.196 lies beside the
0.19608 of its own grey for unknown, 205.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.grid.image import FREE_THRESH, UNKNOWN_GREY, encode_pgm, trinary_from_cells
from robotd.grid.map_yaml import map_yaml
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.grid.tables import NO_INFORMATION
from robotd.grid.turning import turned
from robotd.interop.grey_image import IMAGE_MAX_BYTES, GreyImage, decode_grey, encode_png
from robotd.interop.map_server_yaml import MapServerYaml

__all__ = ["IMAGE_MAX_BYTES", "ImportedMap", "export_map", "import_map"]

_LEVELS = np.arange(256)
_MUCH_WALL = 0.3
"""Walls are lines: more of a map than this share is no building."""


@dataclass(frozen=True, slots=True, eq=False)
class ImportedMap:
    """A map of another program, and what people should know of it."""

    grid: OccupancyGrid
    notes: tuple[str, ...]


def import_map(described: MapServerYaml, picture: bytes) -> ImportedMap:
    """Return a map as its yaml and its picture say.

    Raises:
        MapError: the picture is damaged, or turned it would be larger than any map.
    """
    image = decode_grey(picture)
    cells = _cells_of(described, image)[::-1]  # a picture begins at the largest y
    # Before it is turned: what is said of its pixels is true of the picture.
    notes = _notes(described, image, cells)
    spec = GridSpec(described.resolution_m, described.origin_x_m, described.origin_y_m, cells.shape)
    if described.yaw_rad != 0.0:
        try:
            cells, spec = turned(cells, spec, described.yaw_rad)
        except ValueError as error:
            raise MapError(str(error)) from error
        notes = (
            *notes,
            f"it was turned by {math.degrees(described.yaw_rad):.3g} deg, so its walls are a cell uncertain",
        )
    # Within what settings may be; the cells themselves keep the size that the yaml says.
    settings = GridSettings(resolution_m=min(max(spec.resolution_m, 0.005), 2.0))
    return ImportedMap(OccupancyGrid(spec, np.ascontiguousarray(cells), settings), notes)


def _cells_of(described: MapServerYaml, image: GreyImage) -> NDArray[np.uint8]:
    """Return the values of cells, ``uint8[rows, cols]`` from the top."""
    if described.mode == "raw":
        values = np.full(256, NO_INFORMATION, np.uint8)
        values[:101] = (51 * np.arange(101) + 10) // 20  # 255 / 100, halves up
        return values[image.grey]
    shades = _LEVELS if described.negate else 255 - _LEVELS
    values = shades.astype(np.uint8)
    if described.mode == "trinary":
        probability = shades / 255
        values[(probability > described.free_thresh) & (probability < described.occupied_thresh)] = NO_INFORMATION
        # A threshold above or below a half moves what counts as seen, never what it was seen to be.
        occupied, free = probability >= described.occupied_thresh, probability <= described.free_thresh
        values[occupied] = np.maximum(values[occupied], NO_INFORMATION + 1)
        values[free] = np.minimum(values[free], NO_INFORMATION - 1)
    found = values[image.grey]
    found[image.clear] = NO_INFORMATION
    return found


def _notes(described: MapServerYaml, image: GreyImage, cells: NDArray[np.uint8]) -> tuple[str, ...]:
    notes = []
    unknown_p = (255 - UNKNOWN_GREY) / 255
    if described.mode == "trinary" and not described.negate and described.free_thresh >= unknown_p:
        share = float((image.grey == UNKNOWN_GREY).mean())
        if share > 0.0:
            notes.append(
                f"{share:.0%} of its pixels are {UNKNOWN_GREY}, which most programs write for unknown; with"
                f" free_thresh {described.free_thresh:g} they are free: {FREE_THRESH} makes them unknown"
            )
    walls = float((cells > NO_INFORMATION).mean())
    if walls > _MUCH_WALL:
        notes.append(f"{walls:.0%} of it are walls: was what nobody has seen drawn in black? It then stops beams")
    if walls == 0.0:
        notes.append("it has no walls: nobody can be localized on it")
    if not (cells < NO_INFORMATION).any():
        notes.append("it has no free cells: the robot can be nowhere on it")
    return tuple(notes)


def export_map(grid: OccupancyGrid, stem: str, mode: str) -> dict[str, bytes]:
    """Return the files of a map by name, a picture and its yaml.

    *trinary* is the pgm of three greys that every program reads; *scale* a png that keeps all 256 values (unknown can
    be seen through); *raw* a pgm of 0 to 100, and 255 for unknown.

    Raises:
        ValueError: there is no such mode.
    """
    if mode == "trinary":
        image, picture = f"{stem}.pgm", bytes(encode_pgm(trinary_from_cells(grid.cells)))
    elif mode == "scale":
        clear = grid.cells[::-1] == NO_INFORMATION
        image, picture = f"{stem}.png", encode_png(255 - grid.cells[::-1], clear)
    elif mode == "raw":
        values = np.rint(_LEVELS / 2.55).astype(np.uint8)
        values[NO_INFORMATION] = 255
        image, picture = f"{stem}.pgm", bytes(encode_pgm(values[grid.cells]))
    else:
        raise ValueError(f"expected trinary, scale or raw, got {mode!r}")
    text = map_yaml(image, grid.spec).replace("mode: trinary\n", f"mode: {mode}\n")
    return {image: picture, f"{stem}.yaml": text.encode()}
