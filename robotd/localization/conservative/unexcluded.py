"""The poses that one stop's readings do not exclude: what the conservative mode asks, after any reading.

Other stops ask for the best; this asks for all poses whose rank is no less than the true one's can be
(:mod:`.conservative_poses`): all readings but those that may break their bounds.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.localization.conservative.conservative_rank import ConservativeMap, ConservativeRankGrid
from robotd.localization.count.heading_batches import MEMORY_BYTES, heading_batches
from robotd.localization.count.limits import FEW_HEADINGS, POSES_TOLD_MAX
from robotd.localization.search.cell_disk import CellDisk


class UnexcludedStop:
    """The readings of one stop against all its poses."""

    counted = None

    def __init__(
        self,
        the_map: ConservativeMap,
        headings_rad: tuple[float, ...],
        within: CellDisk | None,
        *,
        outlier_share: float,
        threads: int,
    ) -> None:
        """Begin with no readings.

        Args:
            the_map: the map.
            headings_rad: the headings to try, ascending; the true one lies within the map's bound of one of them.
            within: where the robot is; None is anywhere.
            outlier_share: of the readings, these may break their bounds.
            threads: how many threads may share the work; no answer depends on it.
        """
        self.headings_rad = headings_rad
        self.readings = Readings.none()
        self._map = the_map
        self._within = within
        self._outlier_share = outlier_share
        self._threads = threads
        # With few headings each batch costs only itself; with many, the counts of all would not fit into
        # memory, and all is counted again.
        self._kept = self._grid(self.headings_rad) if len(self.headings_rad) <= FEW_HEADINGS else None

    def add(self, readings: Readings) -> None:
        """Count readings, or keep them where there are too many headings to count as they come."""
        if self._kept is not None:
            self._kept.add(readings)
        self.readings = self.readings.joined(readings)

    def best_poses(self) -> PoseSet:
        """Return all poses that are not excluded.

        O(headings x readings x cells), and a multiple of what :class:`.RankGrid` takes.
        """
        # Rounded down: half an outlier more would be a reading that the promise does not cover.
        least_rank = max(1, len(self.readings) - math.floor(self._outlier_share * len(self.readings)))
        best, count, found = 0, 0, []
        for first, ranks in self._grids():
            best, count = max(best, ranks.best_rank), count + ranks.count_of_rank(least_rank)
            # Too many to tell is the answer whatever the remaining headings would add, so their counting is saved.
            if count > POSES_TOLD_MAX:
                return replace(PoseSet.nothing(best + 1), best_rank=best, is_all=False)
            poses = ranks.cells_of_rank(least_rank)
            found.append((poses + np.array([first, 0, 0]), ranks.rank_at(poses)))
        if count == 0:
            return PoseSet.nothing()
        poses, counts = (np.concatenate(part) for part in zip(*found, strict=True))
        return self._inside(PoseSet(poses, counts, best, least_rank))

    def _grids(self) -> Iterator[tuple[int, ConservativeRankGrid]]:
        """Yield grids that count all readings, each of some headings, and the number of its first heading."""
        if self._kept is not None:
            yield 0, self._kept
            return
        batches = heading_batches(self._map.prepared, len(self.readings), self.headings_rad, MEMORY_BYTES)
        for first, batch_rad in batches:
            ranks = self._grid(batch_rad)
            ranks.add(self.readings)
            yield first, ranks

    def _grid(self, headings_rad: Sequence[float]) -> ConservativeRankGrid:
        return ConservativeRankGrid(self._map, headings_rad, threads=self._threads)

    def _inside(self, found: PoseSet) -> PoseSet:
        """Leave out cells of which no point is where the robot is known to be."""
        if self._within is None:
            return found
        inside = self._within.touches(found.poses[:, 1:])
        # The best rank stays that of all: how many readings any place explains does not depend on where
        # somebody asked.
        return replace(found.part(inside), best_rank=found.best_rank) if inside.any() else PoseSet.nothing()
