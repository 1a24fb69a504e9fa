"""The poses that explain the most of one stop's readings, and all that come near them; asked for after any reading.

There are two ways to the same answer. Where the heading is known, so that there are few to try, readings are counted
as they come (:mod:`.rank`), and asking costs next to nothing. Where it is not, all counts of a building would take
gigabytes: then the readings are kept, and asking searches (:mod:`.search`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.core.reading import RangeReading
from robotd.grid.readings import numbers_of
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.ready_map import ReadyMap
from robotd.localization.search.bounded_search import Disk, best_poses

FEW_HEADINGS = 32
"""So many are counted as the readings come: 256 x 256 cells then take 10 MB."""

POSES_MAX = 1 << 15
"""More answers than this are none; a place that is one has some hundred."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """The poses of high rank."""

    best_rank: int
    """The greatest there is (the paper's kappa); 0 if it is less than what was asked for: that is sooner known."""
    poses: NDArray[np.intp]
    """``intp[n, 3]``, ``(heading, row, col)``, ascending; none if the best explains too few readings, or if there are
    more of greatest rank than can be told."""
    ranks: NDArray[np.uint16]
    """``uint16[n]``."""
    is_all: bool = True
    """Whether these are all that were asked for; there may be too many to tell."""


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

    def answers(self) -> Found:
        """Return the poses that explain most readings, and all that come as near to them as the settings say."""
        settings, readings = self._map.settings, len(self.readings)
        return self.best(math.ceil(settings.rival_share * readings), math.ceil(settings.localized_share * readings))

    def best(self, slack: int, least_rank: int) -> Found:
        """Return the poses that explain ``slack`` readings fewer than the best, if that explains ``least_rank``."""
        return (
            self._searched(slack, least_rank) if self._ranks is None else self._counted(self._ranks, slack, least_rank)
        )

    def _counted(self, ranks: RankGrid, slack: int, least_rank: int) -> Found:
        best_rank = ranks.best_rank
        if best_rank < max(1, least_rank):
            return NOTHING
        poses = ranks.cells_of_rank(max(1, best_rank - slack))
        return Found(best_rank, poses, ranks.rank_at(poses))

    def _searched(self, slack: int, least_rank: int) -> Found:
        prior = None if self._within is None else Disk.of(self._within, self._map.ternary.spec)
        numbers, headings_rad = numbers_of(self.readings), np.array(self.headings_rad)

        found = best_poses(
            self._map.searched,
            numbers,
            headings_rad,
            slack=slack,
            least_rank=max(1, least_rank),
            prior=prior,
            limit=POSES_MAX,
            threads=self._threads,
        )
        if found.best_rank == 0:
            return NOTHING
        is_all = found.least_rank <= max(1, found.best_rank - slack)
        return Found(found.best_rank, found.poses.astype(np.intp), found.ranks, is_all)


NOTHING = Found(0, np.zeros((0, 3), np.intp), np.zeros(0, np.uint16))
"""No pose explains as many readings as were asked for."""
