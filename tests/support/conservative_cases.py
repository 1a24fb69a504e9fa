"""Seeded cases for the promise of the conservative mode: a world of squares, a robot anywhere, errors at the bounds.

The truth is continuous geometry: rays against closed squares.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus

Cells = NDArray[np.bool_]
Floats = NDArray[np.float64]
JUST_INSIDE = 1.0 - 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A world, where the robot is in it, and what it measures."""

    occupied: Cells
    resolution_m: float
    cell: tuple[int, int]
    """Which holds the robot's axis."""
    slices: int
    slice_number: int
    """Of the heading; slice ``k`` is ``2 pi k / slices``."""
    range_error_m: float
    readings: tuple[RangeReading, ...]

    @property
    def heading_error_rad(self) -> float:
        """Half a slice."""
        return math.pi / self.slices


def case_of(seed: int) -> Case:
    """Return the case of a number."""
    random = np.random.default_rng(seed)
    occupied = _world(random)
    cell = random.choice(np.argwhere(~occupied))
    slices, number = _slice(random)
    resolution_m = float(random.choice([0.05, 0.1, 0.37]))
    error_cells = float(random.choice([0.0, 0.5, 1.5, random.uniform(0.0, 3.0), random.uniform(0.5, 0.6)]))
    origin = random.choice([0.0, 0.0, 0.4, 1.0, 2.5]) * random.uniform(-1.0, 1.0, 2)
    bearings = _bearings(random)
    turn_rad = _at_bounds(random) * math.pi / slices
    in_cell = 0.5 * np.array([_at_bounds(random), _at_bounds(random)])
    start, ahead = _beams(origin, bearings, math.tau * number / slices + turn_rad)
    true = first_hits(_squares(occupied), cell + 0.5 + in_cell + start, ahead)
    if random.random() < 0.7:
        ends = in_cell + start + np.where(np.isfinite(true), true, 0.0)[:, None] * ahead
        errors = _worst_errors(ends, true, _beams(origin, bearings, math.tau * number / slices), error_cells)
    else:
        errors = error_cells * np.array([_at_bounds(random) for _ in true])
    cut_off = float(random.choice([4.0, 9.5, 1000.0]))
    missed = (true + errors >= cut_off) | ((true >= cut_off - error_cells) & (random.random(len(true)) < 0.5))
    readings = _readings(bearings, np.where(missed, cut_off, true + errors), missed, origin, resolution_m)
    row, col = cell.tolist()
    return Case(occupied, resolution_m, (row, col), slices, number, error_cells * resolution_m, readings)


def first_hits(squares: Floats, start: Floats, ahead: Floats) -> Floats:
    """Return how far it is to the first of some closed boxes, ``float64[rays]``, ``inf`` if there is none.

    Args:
        squares: ``float64[n, 2, 2]``: least and greatest corner.
        start: ``float64[2]``.
        ahead: ``float64[rays, 2]``, unit vectors.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        ways = (squares[None] - start) / ahead[:, None, None, :]
    # A ray that runs along the very edge of a box is on it: 0 / 0 is no bound.
    enter = np.where(np.isnan(ways), -np.inf, ways).min(axis=2).max(axis=2)
    leave = np.where(np.isnan(ways), np.inf, ways).max(axis=2).min(axis=2)
    hits: Floats = np.where((enter <= leave) & (leave >= 0.0), np.maximum(enter, 0.0), np.inf).min(axis=1)
    return hits


def _squares(occupied: Cells) -> Floats:
    """Return the obstacle cells, and what lies outside as four boxes."""
    rows, cols = occupied.shape
    cells = np.argwhere(occupied).astype(np.float64)
    far = 1e6
    below, above = [[-far, -far], [0.0, far]], [[rows, -far], [far, far]]
    left, right = [[-far, -far], [far, 0.0]], [[-far, cols], [far, far]]
    return np.concatenate((np.stack((cells, cells + 1.0), axis=1), [below, above, left, right]))


def _slice(random: np.random.Generator) -> tuple[int, int]:
    """Return how many slices there are, and one of them; some lie along the walls, where roundings add up."""
    if random.random() < 0.3:
        return 720, 180 * int(random.integers(4))
    slices = int(random.choice([8, 12, 36, 90, 300, 720]))
    return slices, int(random.integers(slices))


def _bearings(random: np.random.Generator) -> Floats:
    count = int(random.choice([4, 8, 24]))
    bearings = np.arange(count) * (math.tau / count) if random.random() < 0.5 else random.uniform(-4.0, 4.0, count)
    return bearings.astype(np.float64)


def _at_bounds(random: np.random.Generator) -> float:
    """Return a number in [-1, 1], more often than not one of its ends."""
    return float(random.choice([-JUST_INSIDE, JUST_INSIDE, random.uniform(-1.0, 1.0)]))


def _beams(origin: Floats, bearings: Floats, heading: float) -> tuple[Floats, Floats]:
    """Return where beams start, seen from the robot, and their directions, all as ``(row, col)``."""
    sin, cos = math.sin(heading), math.cos(heading)
    start = np.array([sin * origin[0] + cos * origin[1], cos * origin[0] - sin * origin[1]])
    return start, np.stack((np.sin(heading + bearings), np.cos(heading + bearings)), axis=1)


def _worst_errors(ends: Floats, true: Floats, drawn: tuple[Floats, Floats], error_cells: float) -> Floats:
    """Return the errors within the bound that round the heads farthest from where the beams end."""
    start, ahead = drawn
    errors = error_cells * np.linspace(-JUST_INSIDE, JUST_INSIDE, 33)
    ranges = np.where(np.isfinite(true), true, 0.0)[:, None] + errors
    heads = np.floor(0.5 + start + ranges[:, :, None] * ahead[:, None])
    worst: Floats = errors[np.abs(heads - ends[:, None]).max(axis=2).argmax(axis=1)]
    return worst


def _readings(
    bearings: Floats, ranges: Floats, missed: Cells, origin: Floats, resolution_m: float
) -> tuple[RangeReading, ...]:
    """Return the readings whose range is one."""
    x_m, y_m = (origin * resolution_m).tolist()
    measured = zip(bearings.tolist(), (ranges * resolution_m).tolist(), missed.tolist(), strict=True)
    status = {True: ReadingStatus.MISS, False: ReadingStatus.OK}
    return tuple(
        RangeReading(0, bearing, status[miss], range_m, origin_x_m=x_m, origin_y_m=y_m)
        for bearing, range_m, miss in measured
        if range_m > 0.0
    )


def _world(random: np.random.Generator) -> Cells:
    """Return clutter, rooms of thin walls, walls at a slant, or solid blocks; some of it is free."""
    rows, cols = random.integers(8, 30, 2).tolist()
    occupied = np.zeros((rows, cols), np.bool_)
    kind = random.integers(4)
    if kind == 0:
        occupied |= random.random((rows, cols)) < random.choice([0.03, 0.1, 0.25])
    elif kind == 1:
        occupied[random.integers(rows, size=2)] = True
        occupied[:, random.integers(cols, size=2)] = True
        occupied &= random.random((rows, cols)) < random.choice([0.85, 1.0])
    elif kind == 2:
        for angle in random.uniform(0.0, math.tau, 3):
            along = np.arange(random.integers(4, 20))[:, None] * np.array([math.sin(angle), math.cos(angle)])
            wall = np.floor(random.integers((rows, cols)) + along).astype(np.intp)
            wall = wall[((wall >= 0) & (wall < (rows, cols))).all(axis=1)]
            occupied[wall[:, 0], wall[:, 1]] = True
    else:
        for row, col, height, width in random.integers((0, 0, 1, 1), (rows, cols, 8, 8), (4, 4)).tolist():
            occupied[row : row + height, col : col + width] = True
    occupied[random.integers(rows), random.integers(cols)] = False
    return occupied
