"""The poses that explain the most readings, and all that come near them, without counting the rest.

The paper's kappa and loc ([BrownDonald2000]_ sec. 2.2.1, 2.2.3): the same answer as
:class:`~robotd.localization.count.rank_grid.RankGrid` over all poses, found by bounds that hold. How, in
:mod:`robotd.grid.kernels`: no cell of a block explains more readings than the block, whose heads may lie anywhere in
it; and a cell is given up as soon as it has missed too many.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid import kernels
from robotd.grid.kernels.search.search_kernel import BUDGET_MAX, Ground, Planes, Question
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.grid.window import CellWindow
from robotd.localization.obstacles.levels import Levels
from robotd.localization.search.cell_disk import CellDisk

_FEW_CELLS = 48 * 48
"""A window so small is looked at cell by cell."""
POSES_MAX = 1 << 18
_WORK_PER_S = 100_000_000
"""How much of a budget is a second: in four recorded buildings 50 to 150 million a second were looked at, the least on
the largest map, on one core of a Xeon with AVX-512 that other programs used, too."""
READINGS_MAX = int(np.iinfo(np.uint16).max)


@dataclass(frozen=True, slots=True, eq=False)
class SearchMap:
    """A map made ready to be searched."""

    spec: GridSpec
    planes: Planes
    rim: int
    """How many cells of the planes lie before the map's first, and after its last."""

    @classmethod
    def of(cls, levels: Levels) -> "SearchMap":
        """Prepare a map; O(cells x levels)."""
        return cls(levels.spec, kernels.in_use().search.make_planes(_ground(levels)), levels.obstacles.rim)

    def updated(self, levels: Levels, window: CellWindow) -> "SearchMap":
        """Return the map after cells changed on some level, all of them in a window; this one stays as it is.

        The window is one of the obstacles, counted with their rim. O(cells near the window), and a copy.
        """
        return replace(self, planes=kernels.in_use().search.renew_planes(self.planes, _ground(levels), window))


def best_poses(
    search_map: SearchMap,
    readings: Readings,
    headings_rad: NDArray[np.float64],
    *,
    slack: int,
    least_rank: int = 1,
    prior: CellDisk | CellWindow | None = None,
    limit: int = POSES_MAX,
    budget_s: float = math.inf,
    threads: int = 1,
) -> PoseSet:
    """Return the best poses: the same whatever the number of threads, and the same as if all had been counted.

    Args:
        search_map: the map.
        readings: hits and misses.
        headings_rad: ``float64[headings]``, the headings to try, map frame.
        slack: poses that explain this many readings fewer than the best are wanted, too.
        least_rank: if no pose explains this many readings, none is returned.
        prior: where poses are wanted; None is everywhere.
        limit: how many poses are returned at most: of more, those above the least rank that leaves few enough.
        budget_s: about how long it may take at most, in work that takes so long on a reference machine.
        threads: how many threads may share the work.

    Raises:
        ValueError: more than 65535 readings.
    """
    if len(readings) > READINGS_MAX:
        raise ValueError(f"a search counts {READINGS_MAX} readings, got {len(readings)}")
    shape = search_map.spec.shape
    window, spans = _spans(prior or CellWindow.whole(shape), shape)
    # The kernel is promised one reading, one heading and one row at least.
    if len(readings) == 0 or len(headings_rad) == 0 or len(spans) == 0:
        return PoseSet.nothing(max(1, least_rank - slack))
    # The laser may sit well away from the robot's axis: beams begin as far beside the map as that.
    farthest_m = float(np.abs(readings.rows[:, 2:4]).max())
    # In work, not in time: how far a search comes must not depend on how busy the machine is, or no recording
    # would replay.
    budget = BUDGET_MAX if math.isinf(budget_s) else int(budget_s * _WORK_PER_S)
    question = Question(
        readings=readings.rows,
        headings_rad=headings_rad,
        resolution_m=search_map.spec.resolution_m,
        slack=slack,
        least_rank=least_rank,
        limit=limit,
        # What is inside the map is inside its rim, and so are columns: the kernel counts all of them with it.
        window=window.moved(search_map.rim),
        by_blocks=window.size > _FEW_CELLS,
        spans=spans + np.int32(search_map.rim),
        reach_cells=2 * (max(shape) + farthest_m / search_map.spec.resolution_m),
        budget=budget,
    )
    found = kernels.in_use().search.search_poses(search_map.planes, question, threads=threads)
    # Back from the planes, which have a rim, to the map, which has none.
    return replace(found, poses=found.poses - np.array([0, search_map.rim, search_map.rim]))


def _spans(prior: CellDisk | CellWindow, shape: tuple[int, int]) -> tuple[CellWindow, NDArray[np.int32]]:
    """Return the window of a grid where poses are wanted, and from which to before which column in each row."""
    if isinstance(prior, CellDisk):
        return prior.spans(shape)
    window = prior.on(shape)
    rows, _ = window.shape
    return window, np.tile(np.array((window.first_col, window.end_col), np.int32), (rows, 1))


def _ground(levels: Levels) -> Ground:
    obstacles = levels.obstacles
    return Ground(
        free=np.ascontiguousarray(obstacles.free),
        blocking=np.ascontiguousarray(obstacles.blocking),
        grown=np.stack([level.obstacles.grown for level in levels.maps]),
        outside_blocks=obstacles.outside_blocks,
        outside_ends=obstacles.outside_ends,
        blocked_by=obstacles.blocked_by,
        radii=levels.radii,
    )
