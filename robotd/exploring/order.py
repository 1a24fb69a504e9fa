"""In which order to make some stops: what is near and what is large early, without running to and fro."""

from collections.abc import Sequence
from itertools import permutations

import numpy as np
from numpy.typing import NDArray


def best_order(times_s: NDArray[np.float64], weights: Sequence[float]) -> tuple[int, ...]:
    """Return the order in which the stops wait least, each by its weight; of equal ones the first. O(stops! stops).

    Args:
        times_s: ``float64[1 + stops, 1 + stops]``, from place to place with the stop made there; first of all from
            where the robot stands.
        weights: of each stop.

    >>> best_order(np.array([[0.0, 2.0, 1.0], [0.0, 0.0, 3.0], [0.0, 3.0, 0.0]]), (1.0, 1.0))
    (1, 0)
    """
    rows, numbers = times_s.tolist(), range(len(weights))
    return min(permutations(numbers), key=lambda order: _waiting(rows, weights, order))


def _waiting(rows: list[list[float]], weights: Sequence[float], order: Sequence[int]) -> float:
    at, time_s, waiting = 0, 0.0, 0.0
    for stop in order:
        time_s += rows[at][stop + 1]
        waiting += weights[stop] * time_s
        at = stop + 1
    return waiting
