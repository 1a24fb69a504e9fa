"""Workload S: a room of 7 x 9 m on 256 x 256 cells of 50 mm, 300 readings, sigma 2 cm, 5 % outliers.

Workload L: the same sweeps in a building of 51 x 51 m on 1024 x 1024 cells, about 40 rooms with doors and furniture.
"""

import math

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.binary import BinaryMap
from robotd.grid.footprints import dilate, disk_footprint
from robotd.localization.obstacles.prepared_map import PreparedMap

RESOLUTION_M = 0.05
CUT_OFF_M = 6.0
READINGS = 300
ERROR_RADIUS_CELLS = 1.5
SPEC = GridSpec(RESOLUTION_M, 0.0, 0.0, (256, 256))
TRUTH = Pose2(6.425, 5.025, 0.0)
LARGE = GridSpec(RESOLUTION_M, 0.0, 0.0, (1024, 1024))
ROOMS = 40
WALL_CELLS, DOOR_CELLS = 3, 18


def room(seed: int = 0) -> NDArray[np.bool_]:
    """Return the room, with a dozen pieces of furniture, as ``bool[rows, cols]``."""
    random = np.random.default_rng(seed)
    occupied = np.ones(SPEC.shape, np.bool_)
    occupied[58:198, 38:218] = False
    for row, col in random.integers((60, 40), (190, 205), (12, 2)).tolist():
        if abs(row - 100) > 15 or abs(col - 128) > 15:
            occupied[row : row + 6, col : col + 8] = True
    return occupied


def open_square() -> NDArray[np.bool_]:
    """Return 256 x 256 cells that are all free but for the rim: the worst case of that size."""
    occupied = np.ones(SPEC.shape, np.bool_)
    occupied[1:-1, 1:-1] = False
    return occupied


def building(seed: int = 1) -> NDArray[np.bool_]:
    """Return rooms made by dividing the largest one again and again, ``bool[rows, cols]``."""
    random = np.random.default_rng(seed)
    occupied = np.ones(LARGE.shape, np.bool_)
    rooms = [(8, 1016, 8, 1016)]
    doors = []
    occupied[8:1016, 8:1016] = False
    while len(rooms) < ROOMS:
        room = rooms.pop(int(np.argmax([(bottom - top) * (right - left) for top, bottom, left, right in rooms])))
        top, bottom, left, right = room
        high = bottom - top > right - left
        first, last = (top, bottom) if high else (left, right)
        wall = int(first + (last - first) * random.uniform(0.35, 0.65))
        across = (left, right) if high else (top, bottom)
        door = int(random.integers(across[0] + 6, across[1] - 6 - DOOR_CELLS))
        if high:
            occupied[wall : wall + WALL_CELLS, left:right] = True
            doors.append((wall - 2, wall + WALL_CELLS + 2, door, door + DOOR_CELLS))
            rooms += [(top, wall, left, right), (wall + WALL_CELLS, bottom, left, right)]
        else:
            occupied[top:bottom, wall : wall + WALL_CELLS] = True
            doors.append((door, door + DOOR_CELLS, wall - 2, wall + WALL_CELLS + 2))
            rooms += [(top, bottom, left, wall), (top, bottom, wall + WALL_CELLS, right)]
    for top, bottom, left, right in rooms:
        _furnish(occupied[top:bottom, left:right], random)
    for top, bottom, left, right in doors:
        occupied[top:bottom, left:right] = False
    return occupied


def _furnish(room: NDArray[np.bool_], random: np.random.Generator) -> None:
    for _ in range(int(random.integers(3, 9))):
        height, width = random.integers(6, 30, 2).tolist()
        row = int(random.integers(0, max(1, room.shape[0] - height)))
        col = int(random.integers(0, max(1, room.shape[1] - width)))
        room[row : row + height, col : col + width] = True


def poses_in(occupied: NDArray[np.bool_], count: int, seed: int = 2) -> list[Pose2]:
    """Return random poses at least 0.3 m from every obstacle."""
    random = np.random.default_rng(seed)
    clear = np.argwhere(~dilate(occupied, disk_footprint(6.0), outside=True))
    cells = random.choice(clear, count) + random.uniform(0.0, 1.0, (count, 2))
    headings_rad = random.uniform(-math.pi, math.pi, count).tolist()
    return [
        Pose2(col * RESOLUTION_M, row * RESOLUTION_M, heading_rad)
        for (row, col), heading_rad in zip(cells.tolist(), headings_rad, strict=True)
    ]


def sweep_of(occupied: NDArray[np.bool_], seed: int = 1, pose: Pose2 = TRUTH) -> Sweep:
    """Return a noisy sweep from a pose."""
    random = np.random.default_rng(seed)
    return Sweep(0, IDENTITY, tuple(_reading(occupied, pose, k, random) for k in range(READINGS)))


def ranges_from(occupied: NDArray[np.bool_], pose: Pose2) -> NDArray[np.float64]:
    """Return how far the walls really are along each bearing of a sweep, up to the cut-off, ``float64[300]``."""
    return np.array([_free_m(occupied, pose, math.tau * number / READINGS) for number in range(READINGS)])


def map_of(occupied: NDArray[np.bool_]) -> PreparedMap:
    """Return the map of a room."""
    return PreparedMap.of_binary(BinaryMap(SPEC, occupied), ERROR_RADIUS_CELLS)


def _reading(occupied: NDArray[np.bool_], pose: Pose2, number: int, random: np.random.Generator) -> RangeReading:
    bearing_rad = math.tau * number / READINGS
    range_m = _free_m(occupied, pose, bearing_rad)
    met_nothing = range_m >= CUT_OFF_M
    if random.random() < 0.05:
        range_m *= random.uniform(0.2, 1.0)
        met_nothing = False
    range_m += random.normal() * 0.02
    if met_nothing or range_m >= CUT_OFF_M:
        return RangeReading(0, bearing_rad, ReadingStatus.MISS, CUT_OFF_M)
    return RangeReading(0, bearing_rad, ReadingStatus.OK, max(range_m, RESOLUTION_M))


def _free_m(occupied: NDArray[np.bool_], pose: Pose2, bearing_rad: float) -> float:
    along_m = np.arange(0.0, CUT_OFF_M, RESOLUTION_M / 10)
    ahead_rad = bearing_rad + pose.heading_rad
    rows = ((pose.y_m + along_m * math.sin(ahead_rad)) / RESOLUTION_M).astype(int)
    cols = ((pose.x_m + along_m * math.cos(ahead_rad)) / RESOLUTION_M).astype(int)
    met = np.flatnonzero(occupied[rows.clip(0, len(occupied) - 1), cols.clip(0, len(occupied) - 1)])
    return float(along_m[met[0]]) if met.size else CUT_OFF_M
