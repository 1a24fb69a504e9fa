"""A room to drive in, made of somebody's map: the borders of its walls, and the most open place to start from."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import ConfigError, MapError
from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.sim.buildings.world import Start, Wall, World
from robotd.sim.physics.walls import Point

_CLEAR_M = 2.0
"""Farther from all walls than this is as good a place to start from as any."""


def load_map_world(path: Path) -> World:
    """Return the room of a map of map_server (its yaml).

    Raises:
        ConfigError: it is no such map, has no place to stand, or what reads it is not installed; says which.
    """
    try:
        from robotd.interop.map_server import IMAGE_MAX_BYTES, import_map  # noqa: PLC0415  # an extra
        from robotd.interop.map_server_yaml import decode_map_yaml  # noqa: PLC0415  # of the same extra
    except ImportError as error:
        raise ConfigError(f"maps as worlds need the extra interop ({error})", file=str(path)) from error
    try:
        told = decode_map_yaml(path.read_bytes())
        with (path.parent / told.image).open("rb") as picture:
            # One byte more than there may be, so that its reader says that it is too long.
            return world_of(path.stem, import_map(told, picture.read(IMAGE_MAX_BYTES + 1)).grid)
    except (MapError, ValueError) as error:
        raise ConfigError(str(error), file=str(path)) from error
    except OSError as error:
        unread = "" if error.filename == str(path) else f"{error.filename}: "
        raise ConfigError(f"{unread}{error.strerror}", file=str(path)) from error


def world_of(name: str, grid: OccupancyGrid) -> World:
    """Return the room that a map shows: light and wheels are stopped where its wall cells begin. O(cells).

    Raises:
        ValueError: it has no walls, or no free cell.
    """
    occupied, free = grid.cells > NO_INFORMATION, grid.cells < NO_INFORMATION
    if not free.any():
        raise ValueError("it has no free cell: the robot can stand nowhere")
    borders = borders_of(occupied, grid.spec)
    start = _open_place(occupied, free, grid.spec)
    return World(name, Start(*start), tuple(Wall(ends, closed=False) for ends in borders))


def borders_of(occupied: NDArray[np.bool_], spec: GridSpec) -> list[tuple[Point, Point]]:
    """Return the borders between wall cells and others, ``bool[rows, cols]``, as segments as long as they go straight.

    The edge of the map is none: what lies beyond is not known to be a wall.
    """
    lying = occupied[1:] != occupied[:-1]  # between a row and the next
    standing = (occupied[:, 1:] != occupied[:, :-1]).T
    segments = []
    for line, first, last in _runs(lying):
        y_m = spec.origin_y_m + (line + 1) * spec.resolution_m
        segments.append(((_x_m(spec, first), y_m), (_x_m(spec, last), y_m)))
    for line, first, last in _runs(standing):
        x_m = _x_m(spec, line + 1)
        segments.append(((x_m, _y_m(spec, first)), (x_m, _y_m(spec, last))))
    return segments


def _x_m(spec: GridSpec, col: int) -> float:
    return spec.origin_x_m + col * spec.resolution_m


def _y_m(spec: GridSpec, row: int) -> float:
    return spec.origin_y_m + row * spec.resolution_m


def _runs(marks: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    """Return ``(line, first, one after the last)`` of every run of marks along a line."""
    padded = np.pad(marks, ((0, 0), (1, 1))).astype(np.int8)  # a run that reaches the edge ends there, too
    steps = np.diff(padded, axis=1)
    lines, firsts = np.nonzero(steps == 1)
    _, lasts = np.nonzero(steps == -1)
    return list(zip(lines.tolist(), firsts.tolist(), lasts.tolist(), strict=True))


def _open_place(occupied: NDArray[np.bool_], free: NDArray[np.bool_], spec: GridSpec) -> Point:
    """Return the free place farthest from walls and unknown ground; of equals, the one nearest to the middle."""
    limit = max(1, round(_CLEAR_M / spec.resolution_m))  # farther off all places are equal, and need no more rounds
    distances = _distances(~free | occupied, limit)
    rows, cols = np.nonzero(free & (distances == distances[free].max()))
    middle = (spec.rows - 1) / 2, (spec.cols - 1) / 2
    best = int(np.argmin((rows - middle[0]) ** 2 + (cols - middle[1]) ** 2))
    return spec.centre_of(int(rows[best]), int(cols[best]))


def _distances(blocked: NDArray[np.bool_], limit: int) -> NDArray[np.int32]:
    """Return how many cells each lies from the nearest blocked one, by squares, up to a limit; the edge is blocked."""
    left = ~np.pad(blocked, 1, constant_values=True)
    found = np.zeros(left.shape, np.int32)
    for _ in range(limit):
        found += left
        left = left & np.roll(left, 1, 0) & np.roll(left, -1, 0) & np.roll(left, 1, 1) & np.roll(left, -1, 1)
        if not left.any():
            break
    return found[1:-1, 1:-1]
