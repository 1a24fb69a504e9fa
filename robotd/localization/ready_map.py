"""A map made ready for all that localization does on it: counting readings, searching, and refining poses."""

from collections.abc import Sequence
from dataclasses import dataclass

from robotd.contract.area import Area
from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.ternary import TernaryMap
from robotd.grid.wall_field import WallField
from robotd.grid.window import CellWindow
from robotd.localization.conservative.conservative_poses import ErrorBounds, SureObstacles
from robotd.localization.conservative.conservative_rank import ConservativeMap
from robotd.localization.conservative.unexcluded import UnexcludedStop
from robotd.localization.count.limits import FEW_HEADINGS
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.likelihood import Likelihood
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.prepared_map import PreparedMap
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.search.bounded_search import SearchMap
from robotd.localization.search.cell_disk import CellDisk
from robotd.localization.settings import LocalizationSettings
from robotd.localization.stop import CountedStop, SearchedStop, Stop


@dataclass(frozen=True, slots=True, eq=False)
class ReadyMap:
    """What is worked out once for a map; it never changes, so it may be shared by threads."""

    ternary: TernaryMap
    settings: LocalizationSettings
    """How it was read."""
    prepared: PreparedMap
    """For counting."""
    searched: SearchMap
    """For the search."""
    walls: WallField
    """For refinement."""
    likelihood: Likelihood
    """For the second look."""
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
            return CountedStop(RankGrid(self.prepared, headings_rad, threads=threads), settings)
        return SearchedStop(self.searched, headings_rad, disk, settings, threads=threads)

    @classmethod
    def of(
        cls, grid: OccupancyGrid, settings: LocalizationSettings, error_model: ErrorModel | None = None
    ) -> "ReadyMap":
        """Make a map ready. O(cells)."""
        ternary = TernaryMap.from_grid(grid)
        unknown, error_radius_cells = settings.unknown, settings.error_radius_cells(ternary.spec.resolution_m)
        obstacles = Obstacles.of_map(ternary, unknown, error_radius_cells, blocked_by=settings.blocked_by)
        prepared = PreparedMap.of(obstacles, ternary.spec, error_radius_cells)
        searched = SearchMap.of(obstacles, ternary.spec, error_radius_cells)
        # Heads are laid on cells that ended beams; what merely blocks only stops a beam that is cast.
        walls = WallField.of(ternary.spec, ternary.occupied, obstacles.blocking)
        likelihood = Likelihood.of(grid.spec, grid.cells, error_model or ErrorModel())
        return cls(ternary, settings, prepared, searched, walls, likelihood, _sure(ternary, settings))

    def updated(self, grid: OccupancyGrid, changed: CellWindow) -> "ReadyMap":
        """Return the map of a grid that differs from the one this is of in a window alone.

        The same as made from nothing; this one stays as it is. O(cells of the window, and of a rim round it), and a
        copy of what is kept.
        """
        if changed.is_empty:
            return self
        ternary = self.ternary.updated(grid, changed)
        prepared = self._prepared(ternary, self.settings.unknown, changed)
        walls = self.walls.updated(ternary.occupied, prepared.obstacles.blocking, changed)
        # A disk reaches whole cells along a row or a column, so rounding its radius down loses none of them.
        radius_cells = int(self.prepared.error_radius_cells)
        searched = self.searched.updated(prepared.obstacles, changed.grown(radius_cells, ternary.spec.shape))
        likelihood = self.likelihood.updated(grid.cells, changed)
        sure = _sure(ternary, self.settings)
        return ReadyMap(ternary, self.settings, prepared, searched, walls, likelihood, sure)

    def _prepared(self, ternary: TernaryMap, unknown: UnknownCells, changed: CellWindow) -> PreparedMap:
        radius_cells = self.prepared.error_radius_cells
        obstacles = self.prepared.obstacles.updated(ternary, unknown, radius_cells, changed)
        return self.prepared.updated(obstacles, changed.grown(int(radius_cells), ternary.spec.shape))


def _sure(ternary: TernaryMap, settings: LocalizationSettings) -> ConservativeMap | None:
    if not settings.conservative:
        return None
    # The true heading lies within half a step of one that is tried: `stop` asks its caller for that.
    bounds = ErrorBounds(settings.range_error_m, settings.heading_step_rad / 2)
    return ConservativeMap.of(SureObstacles.of_map(ternary), ternary.spec, bounds)
