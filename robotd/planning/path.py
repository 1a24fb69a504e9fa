"""From here to there: the planner LILY used ([BrownDonald2000]_ sec. 2.3.2), its way pulled straight.

Obstacles are grown by the robot, a distance field floods out from the goal, and the way is its descent. Whether there
is a way at all is known as soon as the field is.
"""

import enum
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.spec import GridSpec
from robotd.grid.tables import NO_INFORMATION
from robotd.planning.distance_field import NEIGHBOURS, STEP_CELLS, distance_field
from robotd.planning.line_of_sight import in_sight, pulled_straight
from robotd.planning.traversable import free_cells, inflated

Cell = tuple[int, int]
Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class PlanningSettings:
    """The robot as the planner sees it."""

    robot_radius_m: float = 0.3
    """Radius of the disk that the robot fills."""
    clearance_m: float = 0.1
    """What to keep free round it; covers the rounding to cells and small errors of the drive."""
    gap_cells: int = 2
    """Unknown gaps up to so wide, between cells seen free, are taken for free."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        if not self.robot_radius_m > 0.0:
            raise ValueError(f"robot_radius_m must be positive, got {self.robot_radius_m}")
        if not self.clearance_m >= 0.0:
            raise ValueError(f"clearance_m must not be negative, got {self.clearance_m}")
        if not 0 <= self.gap_cells <= 20:
            raise ValueError(f"gap_cells must lie between 0 and 20, got {self.gap_cells}")


@dataclass(frozen=True, slots=True)
class Path:
    """A way round the obstacles."""

    start_m: Point
    waypoints_m: tuple[Point, ...]
    """Corners of the way after the start, map frame; the last is the goal itself."""

    @property
    def legs_m(self) -> tuple[tuple[Point, Point], ...]:
        """The straight legs, from and to."""
        return tuple(zip((self.start_m, *self.waypoints_m), self.waypoints_m, strict=False))

    @property
    def length_m(self) -> float:
        """Length of all legs."""
        return sum(math.dist(*leg) for leg in self.legs_m)


class Hindrance(enum.StrEnum):
    """Why there is no way."""

    OUTSIDE = "the goal lies outside the map"
    OBSTACLE = "the goal lies in an obstacle"
    UNKNOWN = "the goal has not been seen"
    TOO_NEAR = "the goal is too near to an obstacle or to unknown ground for the robot to fit"
    START_OUTSIDE = "the robot stands outside the map"
    NO_WAY = "no way leads to the goal"


@dataclass(frozen=True, slots=True)
class Unreachable:
    """There is no way, and why."""

    hindrance: Hindrance
    nearest_m: Point | None
    """The reachable point nearest to the goal, map frame; None if the robot cannot move at all."""

    @property
    def reason(self) -> str:
        """For people."""
        if self.nearest_m is None:
            return str(self.hindrance)
        return f"{self.hindrance}; the nearest reachable point is ({self.nearest_m[0]:.2f}, {self.nearest_m[1]:.2f}) m"


def plan(grid: OccupancyGrid, start: Pose2, goal_m: Point, settings: PlanningSettings) -> Path | Unreachable:
    """Find the shortest way for the robot's centre from a pose to a point.

    The robot stands where it stands: the cells under it count as free, and if it is nearer to an obstacle than it
    should be, the way begins with a straight leg out of there.
    """
    spec = grid.spec
    here, there = spec.cell_at(start.x_m, start.y_m), spec.cell_at(*goal_m)
    if not spec.contains(*here):
        return Unreachable(Hindrance.START_OUTSIDE, None)
    ground = _Ground.of(grid, here, settings)
    field = distance_field(ground.allowed, there) if spec.contains(*there) else np.full(spec.shape, np.inf)
    exit_cell = ground.way_out(here, field)
    if exit_cell is None:
        return Unreachable(_hindrance(grid, ground, there), _nearest_reachable_m(ground, spec, here, goal_m))
    corners = pulled_straight(ground.allowed, _descent(field, exit_cell))
    inner = corners[1:-1] if exit_cell == here else corners[:-1]
    return Path((start.x_m, start.y_m), (*(spec.centre_of(*cell) for cell in inner), goal_m))


@dataclass(frozen=True, slots=True, eq=False)
class _Ground:
    """Where the robot may be."""

    free: NDArray[np.bool_]
    """``bool[rows, cols]``: no obstacle as far as anybody knows, or under the robot."""
    allowed: NDArray[np.bool_]
    """``bool[rows, cols]``: the robot fits."""
    reach_cells: float
    """How far to look for a way out of a place where it does not fit."""

    @classmethod
    def of(cls, grid: OccupancyGrid, here: Cell, settings: PlanningSettings) -> "_Ground":
        resolution_m = grid.spec.resolution_m
        free = free_cells(grid, settings.gap_cells)
        rows, cols = np.ogrid[: free.shape[0], : free.shape[1]]
        free |= (rows - here[0]) ** 2 + (cols - here[1]) ** 2 <= (settings.robot_radius_m / resolution_m) ** 2
        radius_cells = (settings.robot_radius_m + settings.clearance_m) / resolution_m
        return cls(free, ~inflated(~free, radius_cells), 2.0 * radius_cells)

    def way_out(self, here: Cell, field: NDArray[np.float64]) -> Cell | None:
        """Return where to start on the field: here, or the nearest cell in sight on which the robot fits."""
        if self.allowed[here]:
            return here if np.isfinite(field[here]) else None
        cells = np.argwhere(self.allowed & np.isfinite(field))
        distances = np.hypot(*(cells - here).T)
        near = distances <= self.reach_cells
        for row, col in cells[near][np.argsort(distances[near], kind="stable")].tolist():
            if in_sight(self.free, here, (row, col)):
                return row, col
        return None


def _descent(field: NDArray[np.float64], start: Cell) -> list[Cell]:
    """Return the cells of a shortest way, both ends included."""
    way, (rows, cols) = [start], field.shape
    while field[way[-1]] > 0.0:
        row, col = way[-1]
        onward = [
            (field[row + i, col + j] + step, (row + i, col + j))
            for (i, j), step in zip(NEIGHBOURS, STEP_CELLS, strict=True)
            if 0 <= row + i < rows and 0 <= col + j < cols
        ]
        way.append(min(onward)[1])
    return way


def _hindrance(grid: OccupancyGrid, ground: _Ground, goal: Cell) -> Hindrance:
    if not grid.spec.contains(*goal):
        return Hindrance.OUTSIDE
    if ground.allowed[goal]:
        return Hindrance.NO_WAY
    if ground.free[goal]:
        return Hindrance.TOO_NEAR
    return Hindrance.UNKNOWN if grid.cells[goal] == NO_INFORMATION else Hindrance.OBSTACLE


def _nearest_reachable_m(ground: _Ground, spec: GridSpec, here: Cell, goal_m: Point) -> Point | None:
    start = ground.way_out(here, np.zeros(spec.shape))
    if start is None:
        return None
    cells = np.argwhere(np.isfinite(distance_field(ground.allowed, start)))
    goal = spec.positions_at(np.array([goal_m]))[0] - 0.5
    row, col = cells[np.hypot(*(cells - goal).T).argmin()].tolist()
    return spec.centre_of(row, col)
