"""What tells rivals apart: bearings at which they expect other ranges, and legs at whose end they do.

Rivals are places that the readings so far leave: the same readings, so what differs is what was not looked at yet.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.fit.refinement import expected_ranges

_APART_M = 0.25
"""Ranges that differ by less may be the same."""
_BLOCKED_BY = 2
"""Cells that a beam must meet to be stopped: one lets no beam graze along a wall."""
_BEARINGS_APART_RAD = math.radians(10.0)
"""Nearer to each other, two readings lie on one wall, which counts once."""


@dataclass(frozen=True, slots=True, eq=False)
class Expected:
    """What each of ``n`` rivals expects at each of ``m`` bearings."""

    ranges_m: NDArray[np.float64]
    """``float64[n, m]``, no farther than the cut-off."""

    @classmethod
    def at(
        cls, walls: WallField, poses: Sequence[Pose2], bearings_rad: NDArray[np.float64], cutoff_m: float
    ) -> "Expected":
        """Cast beams from the poses; what is unknown stops them where the map says so."""
        count = len(bearings_rad)
        rows = np.column_stack((bearings_rad, np.full(count, cutoff_m), np.zeros((count, 3))))
        at = np.array([(pose.x_m, pose.y_m, pose.heading_rad) for pose in poses]).reshape(-1, 3)
        ranges = expected_ranges(walls, Readings(np.ascontiguousarray(rows)), at, _BLOCKED_BY)
        # Beyond the cut-off all is a miss: two rivals that differ only there would never be told apart.
        return cls(np.minimum(ranges.ranges_m, cutoff_m))

    def differ(self) -> NDArray[np.bool_]:
        """Return for each pair of rivals at which bearings they differ, ``bool[pairs, m]``."""
        pairs = list(itertools.combinations(range(len(self.ranges_m)), 2))
        one, other = (self.ranges_m[[pair[side] for pair in pairs]] for side in (0, 1))
        differ: NDArray[np.bool_] = np.abs(one - other) > _APART_M
        return differ


def telling_bearings(
    expected: Expected,
    beliefs: Sequence[float],
    bearings_rad: NDArray[np.float64],
    taken_rad: Sequence[float],
    count: int,
) -> tuple[int, ...]:
    """Return the numbers of the bearings that tell most rivals apart, best first, at most ``count``.

    Args:
        expected: what the rivals expect at the bearings.
        beliefs: of the rivals; what is told apart counts by the product of two.
        bearings_rad: ``float64[m]``, to choose from.
        taken_rad: what was chosen so before: nothing is chosen near to it.
        count: how many.
    """
    # The product: to tell two unlikely places apart is worth little, however different they look.
    weights = np.array([one * other for one, other in itertools.combinations(beliefs, 2)])
    worth = weights @ expected.differ()
    chosen: list[int] = []
    near_rad = list(taken_rad)
    for number in np.argsort(-worth, kind="stable").tolist():
        if len(chosen) == count or worth[number] <= 0.0:
            break
        bearing_rad = float(bearings_rad[number])
        if all(abs(math.remainder(bearing_rad - other, math.tau)) >= _BEARINGS_APART_RAD for other in near_rad):
            chosen.append(number)
            near_rad.append(bearing_rad)
    return tuple(chosen)
