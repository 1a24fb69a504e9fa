"""A way of cells pulled straight, like a string, as far as the ground allows."""

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.grid.ray import ray_cells

Cell = tuple[int, int]


def in_sight(free: NDArray[np.bool_], one: Cell, other: Cell) -> bool:
    """Return whether every cell on the straight line between the centres of two cells is free, both ends included."""
    rows, cols = other[0] - one[0], other[1] - one[1]
    start, bearing, length = (
        np.array([one]) + 0.5,
        np.array([math.atan2(rows, cols)]),
        np.array([math.hypot(rows, cols)]),
    )
    _, cells = ray_cells(start, bearing, length, (free.shape[0], free.shape[1]))
    return bool(free[one] and free[other] and free.reshape(-1)[cells].all())


def pulled_straight(free: NDArray[np.bool_], way: Sequence[Cell]) -> list[Cell]:
    """Return the corners of a way: each in sight of the next, and each leg as long as the way stays in sight.

    Args:
        free: ``bool[rows, cols]``.
        way: neighbouring cells, all free.
    """
    corners = [way[0]]
    for last, cell in itertools.pairwise(way):
        if not in_sight(free, corners[-1], cell):
            corners.append(last)
    if len(way) > 1:
        corners.append(way[-1])
    return corners
