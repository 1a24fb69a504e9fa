"""The poses that explain the most of one stop's readings, and all that come near them; asked for after any reading.

There are two ways to the same answer. Where the heading is known, so that there are few to try, readings are counted
as they come (:mod:`.rank_grid`), and asking costs next to nothing. Where it is not, all counts of a building would take
gigabytes: then the readings are kept, and asking searches (:mod:`.bounded_search`).
"""

import math
from collections.abc import Sequence

import numpy as np

from robotd.contract.area import Area
from robotd.core.reading import RangeReading
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import numbers_of
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.ready_map import ReadyMap
from robotd.localization.search.bounded_search import best_poses
from robotd.localization.search.cell_disk import CellDisk

FEW_HEADINGS = 32
"""So many are counted as the readings come: 256 x 256 cells then take 10 MB."""

POSES_MAX = 1 << 15
"""More answers than this are none; a place that is one has some hundred."""


class Count:
    """The readings of one stop against all its poses."""

    def __init__(self, the_map: ReadyMap, headings_rad: Sequence[float], within: Area | None, *, threads: int) -> None:
        """Begin with no readings.

        Args:
            the_map: the map.
            headings_rad: the headings to try, ascending.
            within: where the robot is; None is anywhere.
            threads: how many threads may share the work; no answer depends on it.
        """
        self.headings_rad = tuple(headings_rad)
        self.readings: list[RangeReading] = []
        self._map = the_map
        self._within = within
        self._threads = threads
        is_counted = within is None and len(self.headings_rad) <= FEW_HEADINGS
        self._ranks = RankGrid(the_map.prepared, self.headings_rad, threads=threads) if is_counted else None

    def add(self, *readings: RangeReading) -> None:
        """Take measured readings.

        Raises:
            ValueError: a reading measured nothing; then none is taken.
        """
        if self._ranks is not None:
            self._ranks.add(*readings)
        else:
            numbers_of(readings)
        self.readings.extend(readings)

    def answers(self) -> PoseSet:
        """Return the poses that explain most readings, and all that come as near to them as the settings say."""
        settings, readings = self._map.settings, len(self.readings)
        return self.best(math.ceil(settings.rival_share * readings), math.ceil(settings.localized_share * readings))

    def best(self, slack: int, least_rank: int) -> PoseSet:
        """Return the poses that explain ``slack`` readings fewer than the best, if that explains ``least_rank``."""
        if self._ranks is not None:
            return self._ranks.best_poses(slack, least_rank)
        return self._searched(slack, least_rank)

    def _searched(self, slack: int, least_rank: int) -> PoseSet:
        prior = None if self._within is None else CellDisk.of(self._within, self._map.ternary.spec)
        numbers, headings_rad = numbers_of(self.readings), np.array(self.headings_rad)
        return best_poses(
            self._map.searched,
            numbers,
            headings_rad,
            slack=slack,
            least_rank=max(1, least_rank),
            prior=prior,
            limit=POSES_MAX,
            threads=self._threads,
        )
