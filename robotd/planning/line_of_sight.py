"""A way of points pulled straight, like a string, as far as the ground allows.

Every cell that a leg touches must be free, not one for each step along it: a leg that cuts the corner of a cell is in
that cell, too. Points are in cells, ``(row, col)``, with cell ``(r, c)`` covering ``[r, r+1) x [c, c+1)``.
"""

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Cell = tuple[int, int]
Position = tuple[float, float]

_ON_THE_EDGE = 1e-9
"""A leg that only touches an edge or a corner from outside is in the cells on its own side of it."""
_NO_LENGTH = 1e-12
"""A leg that goes no farther along an axis, in cells, does not go along it at all."""


def centre_of(cell: Cell) -> Position:
    """Return the position of a cell's centre."""
    return cell[0] + 0.5, cell[1] + 0.5


def touched_cells(one: Position, other: Position) -> NDArray[np.intp]:
    """Return the cells that a straight leg runs through, ``intp[n, 2]``, some perhaps twice.

    >>> touched_cells((0.5, 0.5), (1.5, 2.5)).tolist()
    [[0, 0], [0, 1], [1, 2], [0, 0], [1, 1], [1, 2]]
    """
    # Slabs across the axis along which the leg is longer: in each of them it touches two cells at most.
    along = 0 if abs(other[0] - one[0]) > abs(other[1] - one[1]) else 1
    (begin, begin_aside), (end, end_aside) = sorted((point[along], point[1 - along]) for point in (one, other))
    slope = (end_aside - begin_aside) / (end - begin) if end > begin else 0.0
    slabs = np.arange(math.floor(begin), math.floor(end) + 1)
    aside = begin_aside + slope * (np.stack((slabs.clip(begin, end), (slabs + 1).clip(begin, end))) - begin)
    first = np.floor(aside.min(axis=0) + _ON_THE_EDGE)
    last = np.maximum(np.floor(aside.max(axis=0) - _ON_THE_EDGE), first)
    cells = np.stack((np.tile(slabs, 2), np.concatenate((first, last)))).astype(np.intp).T
    return cells if along == 0 else cells[:, ::-1]


def in_sight(free: NDArray[np.bool_], one: Position, other: Position) -> bool:
    """Return whether every cell that the leg between two points touches is free; none is, outside of ``free``."""
    cells = touched_cells(one, other)
    return bool(((cells >= 0) & (cells < free.shape)).all() and free[cells[:, 0], cells[:, 1]].all())


def pulled_straight(free: NDArray[np.bool_], way: Sequence[Position]) -> list[int]:
    """Return which points of a way are its corners: each leg as long as the way stays in sight.

    Args:
        free: ``bool[rows, cols]``.
        way: points that can be reached each from the one before in a straight line.
    """
    corners = [0]
    for last, point in enumerate(way[1:]):
        # The very next point is in sight, as the caller promises: asking could stop the way for ever.
        if last > corners[-1] and not in_sight(free, way[corners[-1]], point):
            # The last point in sight, not the first out of it: legs end where the way was known to be free.
            corners.append(last)
    return [*corners, len(way) - 1] if len(way) > 1 else corners


def distances_of_leg(cells: NDArray[np.intp], one: Position, other: Position) -> NDArray[np.float64]:
    """Return how near a straight leg comes to each of some cells, their squares included, ``float64[n]`` in cells."""
    low = cells.astype(np.float64)
    begin, end = np.array(one), np.array(other)
    along = np.where(np.abs(end - begin) < _NO_LENGTH, 0.0, end - begin)  # dividing by less would overflow
    found = np.minimum(_from_point(low, begin), _from_point(low, end))
    square = float(along @ along)
    if square == 0.0:
        return found
    # A leg and a square that do not meet are nearest at an end of the leg or at a corner of the square.
    for corner in itertools.product((0.0, 1.0), repeat=2):
        off = low + corner - begin
        share = np.clip(off @ along / square, 0.0, 1.0)
        found = np.minimum(found, np.hypot(*(off - share[:, None] * along).T))
    return np.where(_crosses(low, begin, along), 0.0, found)


def _from_point(low: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
    distances: NDArray[np.float64] = np.hypot(*np.maximum(np.maximum(low - point, point - low - 1.0), 0.0).T)
    return distances


def _crosses(low: NDArray[np.float64], begin: NDArray[np.float64], along: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether the leg runs through each square: the shares of it that lie between the square's sides overlap."""
    enter, leave = np.zeros(len(low)), np.ones(len(low))
    for axis in (0, 1):
        near, far = low[:, axis] - begin[axis], low[:, axis] + 1.0 - begin[axis]
        if along[axis] == 0.0:
            # No share can be divided out here; -1 leaves nothing for the other axis to overlap with.
            leave = np.where((near <= 0.0) & (far >= 0.0), leave, -1.0)
            continue
        shares = np.sort(np.stack((near, far)) / along[axis], axis=0)
        enter, leave = np.maximum(enter, shares[0]), np.minimum(leave, shares[1])
    return enter <= leave
