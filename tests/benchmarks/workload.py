"""Workload S: a room of 7 x 9 m on 256 x 256 cells of 50 mm, 300 readings, sigma 2 cm, 5 % outliers."""

import math

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.binary import BinaryMap
from robotd.grid.spec import GridSpec
from robotd.localization.prepared import PreparedMap

RESOLUTION_M = 0.05
CUT_OFF_M = 6.0
READINGS = 300
ERROR_RADIUS_CELLS = 1.5
SPEC = GridSpec(RESOLUTION_M, 0.0, 0.0, (256, 256))
TRUTH = Pose2(6.425, 5.025, 0.0)


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


def sweep_of(occupied: NDArray[np.bool_], seed: int = 1) -> Sweep:
    """Return a noisy sweep from the truth."""
    random = np.random.default_rng(seed)
    return Sweep(0, IDENTITY, tuple(_reading(occupied, k, random) for k in range(READINGS)))


def map_of(occupied: NDArray[np.bool_]) -> PreparedMap:
    """Return the map of a room."""
    return PreparedMap.of_binary(BinaryMap(SPEC, occupied), ERROR_RADIUS_CELLS)


def _reading(occupied: NDArray[np.bool_], number: int, random: np.random.Generator) -> RangeReading:
    bearing_rad = math.tau * number / READINGS
    range_m = _free_m(occupied, bearing_rad)
    if random.random() < 0.05:
        range_m *= random.uniform(0.2, 1.0)
    range_m += random.normal() * 0.02
    if range_m >= CUT_OFF_M:
        return RangeReading(0, bearing_rad, ReadingStatus.MISS, CUT_OFF_M)
    return RangeReading(0, bearing_rad, ReadingStatus.OK, max(range_m, RESOLUTION_M))


def _free_m(occupied: NDArray[np.bool_], bearing_rad: float) -> float:
    along_m = np.arange(0.0, CUT_OFF_M, RESOLUTION_M / 10)
    rows = ((TRUTH.y_m + along_m * math.sin(bearing_rad)) / RESOLUTION_M).astype(int)
    cols = ((TRUTH.x_m + along_m * math.cos(bearing_rad)) / RESOLUTION_M).astype(int)
    met = np.flatnonzero(occupied[rows, cols])
    return float(along_m[met[0]]) if met.size else CUT_OFF_M
