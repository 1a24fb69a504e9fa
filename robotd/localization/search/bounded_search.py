"""The poses that explain the most readings, and all that come near them, without counting the rest.

The paper's kappa and loc ([BrownDonald2000]_ sec. 2.2.1, 2.2.3): the same answer as
:class:`~robotd.localization.count.rank_grid.RankGrid` over all poses, found by bounds that hold. How, in
:mod:`robotd.grid.kernels`: no cell of a block explains more readings than the block, whose heads may lie anywhere in
it; and a cell is given up as soon as it has missed too many.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.core.grid_spec import GridSpec
from robotd.grid import kernels
from robotd.grid.kernels.search.search_kernel import Ground, Planes, Question, Window
from robotd.localization.obstacles.beam_obstacles import Obstacles

_FEW_CELLS = 48 * 48
"""An area so small is looked at cell by cell."""
POSES_MAX = 1 << 18
READINGS_MAX = int(np.iinfo(np.uint16).max)


@dataclass(frozen=True, slots=True)
class Disk:
    """Cells whose centre is near to a place; all lengths in cells, ``(r, c)`` being the centre of that cell."""

    row: float
    col: float
    radius: float

    @classmethod
    def of(cls, area: Area, spec: GridSpec) -> "Disk":
        """Return an area in cells: those whose centres lie within."""
        scale = 1.0 / spec.resolution_m
        row, col = (area.y_m - spec.origin_y_m) * scale - 0.5, (area.x_m - spec.origin_x_m) * scale - 0.5
        return cls(row, col, area.radius_m * scale)

    def area(self, shape: tuple[int, int]) -> tuple[tuple[int, int, int, int], NDArray[np.int32]]:
        """Return the rows and columns that hold the disk, and the columns of each row."""
        first = max(0, math.ceil(self.row - self.radius))
        last = max(first, min(shape[0], math.floor(self.row + self.radius) + 1))
        halves = [math.sqrt(max(self.radius**2 - (row - self.row) ** 2, 0.0)) for row in range(first, last)]
        spans = [(max(0, math.ceil(self.col - h)), min(shape[1], math.floor(self.col + h) + 1)) for h in halves]
        left, right = min((span[0] for span in spans), default=0), max((span[1] for span in spans), default=0)
        if left >= right:
            return (0, 0, 0, 0), np.zeros((0, 2), np.int32)
        return (first, last, left, right), np.array(spans, np.int32)


@dataclass(frozen=True, slots=True)
class Box:
    """Rows from ``row_first`` to before ``row_last``, columns likewise."""

    row_first: int
    row_last: int
    col_first: int
    col_last: int

    def area(self, shape: tuple[int, int]) -> tuple[tuple[int, int, int, int], NDArray[np.int32]]:
        """Return the part of it that lies in the map, and the columns of each row."""
        row_first, row_last = np.clip((self.row_first, self.row_last), 0, shape[0]).tolist()
        col_first, col_last = np.clip((self.col_first, self.col_last), 0, shape[1]).tolist()
        if row_first >= row_last or col_first >= col_last:
            return (0, 0, 0, 0), np.zeros((0, 2), np.int32)
        return (row_first, row_last, col_first, col_last), np.tile(
            np.array((col_first, col_last), np.int32), (row_last - row_first, 1)
        )


Prior = Disk | Box


@dataclass(frozen=True, slots=True, eq=False)
class SearchMap:
    """A map made ready to be searched."""

    spec: GridSpec
    planes: Planes

    @classmethod
    def of(cls, obstacles: Obstacles, spec: GridSpec, error_radius_cells: float) -> "SearchMap":
        """Prepare a map whose obstacles were grown by so much; O(cells)."""
        return cls(spec, kernels.make_planes(_ground(obstacles, error_radius_cells)))

    def updated(self, obstacles: Obstacles, window: Window) -> "SearchMap":
        """Return the map after cells changed, all of them in a window of rows and columns; O(cells near the window).

        The old map is used up: its arrays become the new one's.
        """
        ground = _ground(obstacles, self.planes.ground.error_radius_cells)
        return SearchMap(self.spec, kernels.renew_planes(self.planes, ground, window))


@dataclass(frozen=True, slots=True, eq=False)
class BestPoses:
    """The poses of greatest rank, and those that come near them."""

    best_rank: int
    """The paper's kappa; 0 if it is less than what was asked for."""
    least_rank: int
    """The poses are all that have at least this rank: the best less the slack, at least 1; or more, where these
    would be more than the limit: then the least rank that leaves no more than the limit."""
    poses: NDArray[np.int32]
    """``int32[n, 3]``, ``(heading, row, col)``, ascending."""
    ranks: NDArray[np.uint16]
    """``uint16[n]``: how many readings each explains."""


def best_poses(
    search_map: SearchMap,
    readings: NDArray[np.float64],
    headings_rad: NDArray[np.float64],
    *,
    slack: int,
    least_rank: int = 1,
    prior: Prior | None = None,
    limit: int = POSES_MAX,
    threads: int = 1,
) -> BestPoses:
    """Return the best poses: the same whatever the number of threads, and the same as if all had been counted.

    Args:
        search_map: the map.
        readings: ``float64[n, 5]``, as :func:`robotd.grid.readings.numbers_of` returns them.
        headings_rad: ``float64[headings]``, the headings to try, map frame.
        slack: poses that explain so many readings fewer than the best are wanted, too.
        least_rank: if no pose explains so many readings, none is returned.
        prior: where poses are wanted; None is everywhere.
        limit: how many poses are returned at most.
        threads: how many threads may share the work.

    Raises:
        ValueError: more than 65535 readings.
    """
    if len(readings) > READINGS_MAX:
        raise ValueError(f"a search counts {READINGS_MAX} readings, got {len(readings)}")
    shape = search_map.spec.shape
    area, spans = (prior or Box(0, shape[0], 0, shape[1])).area(shape)
    if len(readings) == 0 or len(headings_rad) == 0 or len(spans) == 0:
        return BestPoses(0, max(1, least_rank - slack), np.zeros((0, 3), np.int32), np.zeros(0, np.uint16))
    farthest_m = float(np.abs(readings[:, 2:4]).max())
    question = Question(
        readings=readings,
        headings_rad=headings_rad,
        resolution_m=search_map.spec.resolution_m,
        slack=slack,
        least_rank=least_rank,
        limit=limit,
        area=area,
        by_blocks=(area[1] - area[0]) * (area[3] - area[2]) > _FEW_CELLS,
        spans=spans,
        reach_cells=2 * (max(shape) + farthest_m / search_map.spec.resolution_m),
    )
    found = kernels.search_poses(search_map.planes, question, threads=threads)
    return BestPoses(found.best_rank, found.least, found.poses[:, :3], found.poses[:, 3].astype(np.uint16))


def _ground(obstacles: Obstacles, error_radius_cells: float) -> Ground:
    return Ground(
        free=np.ascontiguousarray(obstacles.free),
        blocking=np.ascontiguousarray(obstacles.blocking),
        grown=np.ascontiguousarray(obstacles.grown),
        outside_blocks=obstacles.outside_blocks,
        outside_ends=obstacles.outside_ends,
        blocked_by=obstacles.blocked_by,
        error_radius_cells=error_radius_cells,
    )
