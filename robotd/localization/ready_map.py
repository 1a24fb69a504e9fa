"""A map made ready for all that localization does on it: counting readings, searching, and refining poses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.grid.ternary import TernaryMap
from robotd.grid.window import CellWindow
from robotd.localization.conservative.conservative_poses import ErrorBounds, SureObstacles
from robotd.localization.conservative.conservative_rank import ConservativeMap
from robotd.localization.conservative.unexcluded import UnexcludedStop
from robotd.localization.count.limits import FEW_HEADINGS
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.meaning import Meaning
from robotd.localization.obstacles.levels import Levels
from robotd.localization.obstacles.wall_cores import WallCores
from robotd.localization.radii import radii_of
from robotd.localization.search.bounded_search import SearchMap
from robotd.localization.search.cell_disk import CellDisk
from robotd.localization.settings import LocalizationSettings
from robotd.localization.stop import CountedStop, SearchedStop, Stop


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class ReadyMap:
    """What is worked out once for a map; it never changes, so it may be shared by threads."""

    ternary: TernaryMap
    cores: WallCores
    """How thick its walls are drawn."""
    settings: LocalizationSettings
    """How it was read."""
    prepared: Levels
    """For counting."""
    searched: SearchMap
    """For the search."""
    meanings: tuple[Meaning, ...]
    """All that it may mean: what it says and, if its walls are thick, that only their cores stand."""
    sure: ConservativeMap | None
    """For the conservative mode; None if it is not asked for."""

    @property
    def spec(self) -> GridSpec:
        """Where the cells lie."""
        return self.ternary.spec

    def stop(self, headings_rad: Sequence[float], within: Area | None = None, *, threads: int = 1) -> Stop:
        """Begin a stop: a robot stands somewhere on this map, and nothing was measured yet.

        Args:
            headings_rad: the headings to try, map frame, ascending; in the conservative mode the true one lies within
                half a step of one of them.
            within: where the robot is; None is anywhere.
            threads: how many threads may share the work; no answer depends on it.
        """
        headings_rad, settings = tuple(headings_rad), self.settings
        disk = None if within is None else CellDisk.of(within, self.spec)
        if self.sure is not None:
            share = settings.outlier_share
            return UnexcludedStop(self.sure, headings_rad, disk, outlier_share=share, threads=threads)
        # A rank grid counts the whole map; within a disk, a search looks only at the cells that are wanted.
        if disk is None and len(headings_rad) <= FEW_HEADINGS:
            return CountedStop(self.prepared, headings_rad, settings, threads=threads)
        return SearchedStop(self.searched, headings_rad, disk, settings, threads=threads)

    @classmethod
    def of(
        cls, grid: OccupancyGrid, settings: LocalizationSettings, error_model: ErrorModel | None = None
    ) -> "ReadyMap":
        """Make a map ready. O(cells)."""
        cores = WallCores.of(grid.cells > NO_INFORMATION, grid.spec.resolution_m, settings.thick_walls)
        return cls._of(grid, cores, settings, error_model or ErrorModel())

    @classmethod
    def _of(
        cls, grid: OccupancyGrid, cores: WallCores, settings: LocalizationSettings, errors: ErrorModel
    ) -> "ReadyMap":
        ternary = TernaryMap.from_grid(grid)
        levels = Levels.of_map(
            ternary,
            settings.unknown,
            radii_of(settings, grid.spec),
            blocked_by=settings.blocked_by,
            before_cores=cores.before_cores(),
        )
        meanings = tuple(
            Meaning.of(grid.spec, cells, _blocking(levels), errors) for cells in cores.readings_of(grid.cells)
        )
        return cls(ternary, cores, settings, levels, SearchMap.of(levels), meanings, _sure(ternary, settings))

    def updated(self, grid: OccupancyGrid, changed: CellWindow) -> "ReadyMap":
        """Return the map of a grid that differs from the one this is of in a window alone.

        The same as made from nothing; this one stays as it is. O(cells of the window, and of a rim round it), and a
        copy of what is kept; O(cells) where walls are thick, or are found to be so.
        """
        if changed.is_empty:
            return self
        ternary = self.ternary.updated(grid, changed)
        cores = self.cores.updated(ternary.occupied, changed)
        # The pen is another, which is seen on all of the map at once: no window holds such a change.
        if cores.depth_cells != self.cores.depth_cells:
            return self._of(grid, cores, self.settings, self.meanings[0].likelihood.model)
        # A wall cell that changed moves the core of the wall round it.
        changed = changed.grown(cores.reach_cells, ternary.spec.shape)
        levels = self.prepared.updated(ternary, self.settings.unknown, changed, cores.before_cores())
        searched = self.searched.updated(levels, levels.reach(changed))
        meanings = tuple(
            meaning.updated(cells, _blocking(levels), changed)
            for meaning, cells in zip(self.meanings, cores.readings_of(grid.cells), strict=True)
        )
        return ReadyMap(ternary, cores, self.settings, levels, searched, meanings, _sure(ternary, self.settings))


def _blocking(levels: Levels) -> NDArray[np.bool_]:
    """Return the cells of the map that stop a beam, ``bool[rows, cols]``."""
    return levels.obstacles.on_map(levels.obstacles.blocking)


def _sure(ternary: TernaryMap, settings: LocalizationSettings) -> ConservativeMap | None:
    if not settings.conservative:
        return None
    # The true heading lies within half a step of one that is tried: `stop` asks its caller for that.
    bounds = ErrorBounds(settings.range_error_m, settings.heading_step_rad / 2)
    return ConservativeMap.of(SureObstacles.of_map(ternary), ternary.spec, bounds)
