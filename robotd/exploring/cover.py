"""Stops that together look behind all that is open, found one by one: each adds the most for the time that it takes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.exploring.settings import Pace

_SETTLED = 0.25
"""A stretch of the border is settled by a place that sees at least this share behind it of what any place does."""
_STOPS_MAX = 6
"""Later ones are chosen when more is known; and of six stops all orders can be tried."""


@dataclass(frozen=True, slots=True, eq=False)
class Covering:
    """Some of several places, and how far they are from each other."""

    places: tuple[int, ...]
    """By their numbers, as they were found."""
    ways_m: NDArray[np.float64]
    """``float64[1 + places, 1 + places]``, from place to place; first of all from where the robot stands."""


def covering(
    behind_m2: NDArray[np.float64],
    ways_m: NDArray[np.float64],
    ways_from: Callable[[int], NDArray[np.float64]],
    pace: Pace,
    least_m2: float,
) -> Covering:
    """Return places from which all that is open is looked behind; at least one. O(stops places stretches).

    Args:
        behind_m2: ``float64[places, stretches]``, terrain that each place is expected to add behind each stretch.
        ways_m: ``float64[places]``, from the robot to each place.
        ways_from: the same from one of the places, by its number.
        pace: how fast this robot is.
        least_m2: what adds less than this is not worth a stop.
    """
    most_m2 = behind_m2.max(axis=0)
    is_left = np.ones(behind_m2.shape[1], np.bool_)
    detours_m, found, rows_m = ways_m, list[int](), [ways_m]
    while len(found) < _STOPS_MAX:
        adds_m2 = behind_m2 @ is_left
        worth = np.where(adds_m2 >= least_m2, adds_m2, 0.0) if found else adds_m2
        best = int(np.argmax(worth / (pace.sweep_s + detours_m / pace.speed_mps)))
        if found and worth[best] == 0.0:
            break
        found.append(best)
        is_left &= behind_m2[best] < _SETTLED * most_m2
        rows_m.append(ways_from(best))
        detours_m = np.minimum(detours_m, rows_m[-1])
    between_m = np.array([row_m[found] for row_m in rows_m])
    return Covering(tuple(found), np.column_stack((np.append(0.0, between_m[0]), between_m)))
