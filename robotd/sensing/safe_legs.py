"""Where to drive when a whole sweep leaves rivals: a leg that is free under each of them, with another view at its end.

The robot does not know where it is, so a leg is driven only if it would be free from every place where it may be. What
it would see at the end is cast from each of these places; what counts is how much of it differs, for the time it takes.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.wall_field import WallField
from robotd.planning.line_of_sight import touched_cells
from robotd.sensing.rivals import Leg, Rival
from robotd.sensing.telling_apart import Expected

_DIRECTIONS = 36
_LENGTHS_M = (0.6, 1.0, 1.5, 2.2, 3.0)
_BEAMS = 60
"""Of a predicted sweep."""
_ENOUGH_SHARE = 0.3
"""More of a sweep need not differ to tell two places apart."""
_LEAST_SHARE = 0.05
"""Where less of a sweep differs, it tells nothing apart."""
_SWEEP_S = 30.0
"""What the sweep at the end takes, about: it keeps short legs from being all that counts."""
_LEAVING_M = 0.15
"""The robot stands where it stands: what it would touch so near to its start is not asked."""
_CLEAR_FROM_M = 0.4
"""From here on a leg keeps the clearance, too; before it the robot may stand nearer to a wall than it would drive."""


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """Where the robot's centre may be."""

    spec: GridSpec
    tight: NDArray[np.bool_]
    """``bool[rows, cols]``: its disk touches nothing there."""
    clear: NDArray[np.bool_]
    """``bool[rows, cols]``: nor with the clearance round it."""

    def is_free(self, begin_m: tuple[float, float], heading_rad: float, length_m: float) -> bool:
        """Return whether a leg from a point can be driven."""
        ahead = np.array([math.cos(heading_rad), math.sin(heading_rad)])
        if length_m <= _LEAVING_M:
            return True
        middle_m = min(_CLEAR_FROM_M, length_m)
        begin = np.array(begin_m)
        pieces = ((self.tight, _LEAVING_M, middle_m), (self.clear, middle_m, length_m))
        return all(self._holds(free, begin + low * ahead, begin + high * ahead) for free, low, high in pieces)

    def _holds(self, free: NDArray[np.bool_], begin_m: NDArray[np.float64], end_m: NDArray[np.float64]) -> bool:
        begin, end = self.spec.positions_at(np.stack((begin_m, end_m)))
        cells = touched_cells((float(begin[0]), float(begin[1])), (float(end[0]), float(end[1])))
        inside = ((cells >= 0) & (cells < free.shape)).all()
        return bool(inside and free[cells[:, 0], cells[:, 1]].all())


def best_leg(room: Room, walls: WallField, rivals: Sequence[Rival], cutoff_m: float, speed_mps: float) -> Leg | None:
    """Return the leg that tells most rivals apart in the time it takes; None if none is free under each of them.

    Where none tells any apart, it is the longest.

    Args:
        room: where the robot may be.
        walls: of the map.
        rivals: at least two places where it may stand.
        cutoff_m: how far a reading sees.
        speed_mps: of the base.
    """
    free = [
        (direction_rad, length_m)
        # In the robot's frame: the leg is the one thing that all rivals have in common.
        for direction_rad in (number * math.tau / _DIRECTIONS for number in range(_DIRECTIONS))
        for length_m in _free_lengths(room, rivals, direction_rad)
    ]
    if not free:
        return None
    legs = [
        Leg(
            length_m * math.cos(direction_rad),
            length_m * math.sin(direction_rad),
            _told_apart(walls, rivals, (direction_rad, length_m), cutoff_m),
        )
        for direction_rad, length_m in free
    ]
    # Per second: a long leg tells more, and takes as long as two short ones with a sweep between.
    worth = [leg.told_apart / (_SWEEP_S + length_m / speed_mps) for leg, (_, length_m) in zip(legs, free, strict=True)]
    best = max(range(len(legs)), key=lambda number: worth[number])
    if legs[best].told_apart < _LEAST_SHARE:
        # Nothing tells apart from any of these: the longest leads farthest from the view that all have in
        # common.
        best = max(range(len(legs)), key=lambda number: free[number][1])
    return legs[best]


def _free_lengths(room: Room, rivals: Sequence[Rival], direction_rad: float) -> list[float]:
    """Return how far the robot may drive in a direction, wherever it is."""
    lengths_m = []
    for length_m in _LENGTHS_M:
        if not all(
            room.is_free(spot_m, rival.pose.heading_rad + direction_rad, length_m)
            for rival in rivals
            for spot_m in rival.spots_m
        ):
            # What stands in the way of a leg stands in the way of each longer one.
            break
        lengths_m.append(length_m)
    return lengths_m


def _told_apart(walls: WallField, rivals: Sequence[Rival], leg: tuple[float, float], cutoff_m: float) -> float:
    direction_rad, length_m = leg
    # It arrives facing along the leg, and so the sweep there is predicted.
    step = Pose2(length_m * math.cos(direction_rad), length_m * math.sin(direction_rad), direction_rad)
    bearings_rad = np.linspace(0.0, math.tau, _BEAMS, endpoint=False)
    expected = Expected.at(walls, [rival.pose @ step for rival in rivals], bearings_rad, cutoff_m)
    shares = expected.differ().mean(axis=1)
    # Cut off at enough: else two rivals that differ in everything would outweigh all those that are still
    # alike.
    return float(np.minimum(shares, _ENOUGH_SHARE).mean())
