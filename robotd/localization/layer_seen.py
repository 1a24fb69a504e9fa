"""A further layer of the map, and what is seen at its tilt: the places that it speaks against are no answers.

A map without heights is true of one height. Each further tilt therefore has a map of its own, with the poses of the
first one's stops. A pose is an answer if it is one on the first layer, and each further one agrees: the robot may stand
there, and the layer explains there as many of its readings as at any other such pose, but for the share that makes a
rival ([BrownDonald2000]_ sec. 2.2.1, layer by layer). Where a layer has seen nothing it has no say.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import Tilt
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.localization.count.heading_batches import MEMORY_BYTES, heading_batches
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.judge.second_look import LayerView
from robotd.localization.obstacles.levels import Levels
from robotd.localization.ready_map import ReadyMap


class LayerSeen:
    """One layer at one stop."""

    def __init__(self, tilt: Tilt, the_map: ReadyMap) -> None:
        """Begin with no readings."""
        self.tilt = tilt
        self.readings = Readings.none()
        self._map = the_map

    def add(self, readings: Readings) -> None:
        """Take readings that were made at its tilt."""
        self.readings = self.readings.joined(readings)

    @property
    def view(self) -> LayerView:
        """What the second look has of it."""
        # As its walls are drawn: maps that have layers are the robot's own, and were drawn with a thin pen.
        return LayerView(self._map.meanings[0].likelihood, self.readings)

    def agreeing(self, found: PoseSet, headings_rad: Sequence[float]) -> tuple[PoseSet, int]:
        """Return the poses that it does not speak against, and the greatest rank that it gives to one of them.

        Args:
            found: on the first layer, and by those that were asked before.
            headings_rad: what the headings are.
        """
        rows, cols = found.poses[:, 1], found.poses[:, 2]
        # What is an obstacle at this height is no place to stand, whatever the others say.
        stands = ~self._map.ternary.occupied[rows, cols]
        judged = self._map.ternary.vacant[rows, cols]
        ranks = np.zeros(len(found), np.int64)
        ranks[judged] = _ranks_at(self._map.prepared, self.readings, found.poses[judged], headings_rad)
        best = int(ranks.max(initial=0))
        slack = math.ceil(self._map.settings.rival_share * len(self.readings))
        return found.part(stands & (~judged | (ranks >= best - slack))), best


def _ranks_at(
    levels: Levels, readings: Readings, poses: NDArray[np.intp], headings_rad: Sequence[float]
) -> NDArray[np.uint16]:
    """Return how many readings each of some free poses ``intp[n, 3]`` explains, ``uint16[n]``."""
    ranks = np.zeros(len(poses), np.uint16)
    # Only headings of which there is a pose: mostly few of those that were tried.
    numbers, which = np.unique(poses[:, 0], return_inverse=True)
    tried_rad = [headings_rad[number] for number in numbers.tolist()]
    for first, batch_rad in heading_batches(levels.maps[0], len(readings), tried_rad, MEMORY_BYTES):
        counted = RankGrid(levels.maps[0], batch_rad)
        counted.add_by_level(readings, levels)
        here = (which >= first) & (which < first + len(batch_rad))
        ranks[here] = counted.rank_at(np.column_stack((which[here] - first, poses[here, 1:])))
    return ranks
