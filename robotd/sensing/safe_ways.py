"""Where to drive when a whole sweep leaves rivals: a way that is free under each of them, with another view at its end.

The robot does not know where it is, so it drives through what is free from every place where it may be. What it would
see at the end is cast from each of these places; what counts is how much of it differs, for the time it takes.
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from robotd.core.pose import Pose2
from robotd.grid.wall_field import WallField
from robotd.planning.line_of_sight import Cell
from robotd.sensing.common_ground import CommonGround, Room
from robotd.sensing.rivals import Rival, SafeWay
from robotd.sensing.telling_apart import Expected

_APART_M = 0.4
"""Between ends that are looked at."""
_ENDS_MAX = 200
_NEAREST_M = 0.5
"""An end nearer than this sees what is seen from here."""
_PART_M = 3.0
"""So far the robot drives without a look: its wheels err by as much as ways keep clear of walls."""
_LEAST_PART_M = 0.3
_BEAMS = 60
"""Of a predicted sweep."""
_ENOUGH_SHARE = 0.3
"""More of a sweep need not differ to tell two places apart."""
_LEAST_SHARE = 0.1
"""Where less of a sweep differs, it tells nothing apart: on a map, rooms that are alike differ by up to that."""
_SWEEP_S = 30.0
"""What the sweep at the end of each part takes, about: it keeps short ways from being all that counts."""


def best_way(
    room: Room, walls: WallField, rivals: Sequence[Rival], cutoff_m: float, speed_mps: float
) -> SafeWay | None:
    """Return the way that tells most rivals apart in the time it takes; None if none is free under each of them.

    Where none tells any apart, it is the longest. It is so long as the robot may drive without another look; where
    more of it is left, the rest is for after that.

    Args:
        room: where the robot may be.
        walls: of the map.
        rivals: at least two places where it may stand.
        cutoff_m: how far a reading sees.
        speed_mps: of the base.
    """
    ground = CommonGround.of(room, rivals)
    ends = _ends(ground)
    told_apart = {end: _told_apart(walls, rivals, Pose2(*ground.point_m(end), 0.0), cutoff_m) for end in ends}

    ways_m = ground.ways_m

    def worth(end: Cell) -> float:
        way_m = float(ways_m[end])
        return told_apart[end] / (math.ceil(way_m / _PART_M) * _SWEEP_S + way_m / speed_mps)

    telling = sorted((end for end in ends if told_apart[end] >= _LEAST_SHARE), key=worth, reverse=True)
    longest = sorted(ends, key=lambda end: float(ways_m[end]), reverse=True)
    return next(_ways(ground, (*telling, *longest), told_apart), None)


def _ends(ground: CommonGround) -> list[Cell]:
    """Return where a way may end, the nearest first."""
    step = max(1, round(_APART_M / ground.cell_m))
    half = len(ground.cells) // 2
    rows, cols = (np.arange(half % step, len(ground.cells), step) for _ in range(2))
    ways_m = ground.ways_m[np.ix_(rows, cols)]
    near_first = np.argsort(ways_m, axis=None, kind="stable")
    reached = [at for at in near_first.tolist() if _NEAREST_M <= ways_m.flat[at] < math.inf]
    some = reached[:: max(1, -(-len(reached) // _ENDS_MAX))]
    return [(int(rows[at // len(cols)]), int(cols[at % len(cols)])) for at in some]


def _ways(ground: CommonGround, ends: Sequence[Cell], told_apart: dict[Cell, float]) -> Iterator[SafeWay]:
    """Yield what can be driven of the ways to ends."""
    ways_m = ground.ways_m
    for end in ends:
        part = ground.free_part(ground.way_to(end), _PART_M)
        length_m = sum(map(math.dist, ((0.0, 0.0), *part), part))
        if length_m >= _LEAST_PART_M:
            yield SafeWay(part, length_m, max(0.0, float(ways_m[end]) - length_m), told_apart[end])


def _told_apart(walls: WallField, rivals: Sequence[Rival], step: Pose2, cutoff_m: float) -> float:
    bearings_rad = np.linspace(0.0, math.tau, _BEAMS, endpoint=False)
    expected = Expected.at(walls, [rival.pose @ step for rival in rivals], bearings_rad, cutoff_m)
    shares = expected.differ().mean(axis=1)
    return float(np.minimum(shares, _ENOUGH_SHARE).mean())
