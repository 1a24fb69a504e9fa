"""The readings of one stop against all its poses: rnk and loc, asked for after any reading.

There are two ways to the same answer. Where the heading is known, so that there are few to try, readings are counted
as they come (:mod:`.rank_grid`), and asking costs next to nothing. Where it is not, all counts of a building would take
gigabytes: then the readings are kept, and asking searches (:mod:`.bounded_search`). The conservative mode has a third
(:mod:`.unexcluded`), which asks something else.
"""

import math
from typing import Protocol

import numpy as np

from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.localization.count.limits import POSES_TOLD_MAX
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.obstacles.levels import Levels
from robotd.localization.search.bounded_search import SearchMap, best_poses
from robotd.localization.search.cell_disk import CellDisk
from robotd.localization.settings import LocalizationSettings


class Stop(Protocol):
    """A robot that stands and measures."""

    @property
    def headings_rad(self) -> tuple[float, ...]:
        """The headings that are tried, map frame, ascending."""

    @property
    def readings(self) -> Readings:
        """What was measured so far."""

    def add(self, readings: Readings) -> None:
        """Take readings; many at once cost less than one after the other."""

    def best_poses(self) -> PoseSet:
        """Return the poses that explain the most readings, and all that come near them."""

    @property
    def counted(self) -> RankGrid | None:
        """How many readings each pose explains, where they are counted as they come."""


class CountedStop:
    """Counts readings as they come."""

    def __init__(
        self, levels: Levels, headings_rad: tuple[float, ...], settings: LocalizationSettings, *, threads: int
    ) -> None:
        """Begin with counters in which nothing was counted; arguments as of :meth:`.ReadyMap.stop`."""
        self.headings_rad = headings_rad
        self.readings = Readings.none()
        self._levels = levels
        self.counted = RankGrid(levels.maps[0], headings_rad, threads=threads)
        self._settings = settings

    def add(self, readings: Readings) -> None:
        """Count readings."""
        self.counted.add_by_level(readings, self._levels)
        self.readings = self.readings.joined(readings)

    def best_poses(self) -> PoseSet:
        """Look up the best poses."""
        return self.counted.best_poses(*_asked_for(self._settings, len(self.readings)))


class SearchedStop:
    """Keeps readings, and searches when it is asked."""

    counted = None

    def __init__(
        self,
        the_map: SearchMap,
        headings_rad: tuple[float, ...],
        within: CellDisk | None,
        settings: LocalizationSettings,
        *,
        threads: int,
    ) -> None:
        """Begin with no readings; arguments as of :meth:`.ReadyMap.stop`."""
        self.headings_rad = headings_rad
        self.readings = Readings.none()
        self._map = the_map
        self._within = within
        self._settings = settings
        self._threads = threads

    def add(self, readings: Readings) -> None:
        """Keep readings."""
        self.readings = self.readings.joined(readings)

    def best_poses(self) -> PoseSet:
        """Search for the best poses."""
        slack, least_rank = _asked_for(self._settings, len(self.readings))
        return best_poses(
            self._map,
            self.readings,
            np.array(self.headings_rad),
            slack=slack,
            least_rank=max(1, least_rank),
            prior=self._within,
            limit=POSES_TOLD_MAX,
            budget_s=self._settings.budget_s,
            threads=self._threads,
        )


def _asked_for(settings: LocalizationSettings, readings: int) -> tuple[int, int]:
    """Return how many readings fewer than the best a pose may explain, and how many the best must."""
    # Both are rounded to the cautious side: rather one rival more, and rather lost than localized by half a reading.
    return math.ceil(settings.rival_share * readings), math.ceil(settings.localized_share * readings)
