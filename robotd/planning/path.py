"""From here to there: the planner LILY used ([BrownDonald2000]_ sec. 2.3.2), its way pulled straight.

Obstacles are grown by the robot, a distance field floods out from the goal, and the way is its descent. Whether there
is a way at all is known as soon as the field is. Along every leg, from where the robot stands to the goal itself, its
disk meets no cell that is taken for an obstacle, whatever clearance is set.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.ways import Hindrance, Point
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.planning.distance_field import NEIGHBOURS, STEP_CELLS, distance_field
from robotd.planning.line_of_sight import Cell, centre_of, distances_of_leg, pulled_straight
from robotd.planning.settings import PlanningSettings
from robotd.planning.terrain import Terrain, position
from robotd.planning.traversable import lone_hits

_AT_CELLS = 1.0
"""What was hit so near to the goal is where the robot is sent to, not something on its way."""

_WORDS = {
    Hindrance.OUTSIDE: "the goal lies outside the map",
    Hindrance.OBSTACLE: "the goal lies in an obstacle",
    Hindrance.UNKNOWN: "the goal has not been seen",
    Hindrance.TOO_NEAR: "the goal is too near to an obstacle or to unknown terrain for the robot to fit",
    Hindrance.START_OUTSIDE: "the robot stands outside the map",
    Hindrance.NO_WAY: "no way leads to the goal",
}
"""For people; recordings have them, so they stay."""


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


@dataclass(frozen=True, slots=True)
class Unreachable:
    """There is no way, and why."""

    hindrance: Hindrance
    nearest_m: Point | None
    """The reachable point nearest to the goal, map frame; None if the robot cannot move at all."""

    @property
    def reason(self) -> str:
        """For people."""
        words = _WORDS[self.hindrance]
        if self.nearest_m is None:
            return words
        return f"{words}; the nearest reachable point is ({self.nearest_m[0]:.2f}, {self.nearest_m[1]:.2f}) m"


def plan(
    grid: OccupancyGrid,
    start: Pose2,
    goal_m: Point,
    settings: PlanningSettings,
    hit: NDArray[np.bool_] | None = None,
) -> Path | Unreachable:
    """Find the shortest way for the robot's centre from a pose to a point.

    Lone hits, which a wrong range may have left, are gone round like any other obstacle; only if then there is no way,
    and none of them is at the goal itself, they are taken for wrong ranges.

    The robot stands where it stands: the cells under it count as free, and if it is nearer to an obstacle than it
    should be, the way begins with a straight leg out of there that takes it no nearer.

    Args:
        grid: the map.
        start: where the robot stands, map frame.
        goal_m: where it shall go, map frame.
        settings: the robot.
        hit: ``bool[rows, cols]``, cells that are obstacles whatever the grid says of them.
    """
    spec = grid.spec
    if not spec.contains(*spec.cell_at(start.x_m, start.y_m)):
        return Unreachable(Hindrance.START_OUTSIDE, None)
    hit = np.zeros(spec.shape, np.bool_) if hit is None else hit
    # Without doubt first: what was hit once may be a table's leg, and only where nothing else leads on is it
    # worth the risk.
    answer = _planned(grid, Terrain.of(grid, start, hit, None, settings), start, goal_m)
    lone = lone_hits(grid, hit)
    if isinstance(answer, Path) or not lone.any() or _is_at(lone, spec, goal_m):
        return answer
    doubting = _planned(grid, Terrain.of(grid, start, hit, lone, settings), start, goal_m)
    # Where doubt does not help either, the answer without it names what is really in the way.
    return doubting if isinstance(doubting, Path) else answer


def _is_at(lone: NDArray[np.bool_], spec: GridSpec, goal_m: Point) -> bool:
    goal = position(spec, goal_m)
    return bool((distances_of_leg(np.argwhere(lone), goal, goal) <= _AT_CELLS).any())


def _planned(grid: OccupancyGrid, terrain: Terrain, start: Pose2, goal_m: Point) -> Path | Unreachable:
    spec = grid.spec
    here, there = spec.cell_at(start.x_m, start.y_m), spec.cell_at(*goal_m)
    # From the goal and not from the robot: then one field also tells which way out of a tight place is the
    # shortest.
    field = distance_field(terrain.allowed, there) if spec.contains(*there) else np.full(spec.shape, np.inf)
    exit_cell = terrain.way_out(here, field)
    if exit_cell is None:
        return Unreachable(_hindrance(grid, terrain, there), _nearest_reachable_m(terrain, spec, here, goal_m))
    cells = descent(field, exit_cell)
    way = [centre_of(cell) for cell in cells] + [position(spec, goal_m)]
    points_m = [spec.centre_of(*cell) for cell in cells] + [goal_m]
    # Where the robot does not fit, the leg out of there was checked by itself, and the string begins at its end.
    if terrain.allowed[here]:
        way, points_m = [terrain.start, *way], [(start.x_m, start.y_m), *points_m]
    corners = pulled_straight(terrain.allowed, way)
    onward = corners[1:] if terrain.allowed[here] else corners
    return Path((start.x_m, start.y_m), tuple(points_m[corner] for corner in onward))


def descent(field: NDArray[np.float64], start: Cell) -> list[Cell]:
    """Return the cells of a shortest way, both ends included."""
    way, (rows, cols) = [start], field.shape
    while field[way[-1]] > 0.0:
        row, col = way[-1]
        onward = [
            # With the step to it: a corner step is longer, so the neighbour with the smallest field may be a detour.
            (field[row + i, col + j] + step, (row + i, col + j))
            for (i, j), step in zip(NEIGHBOURS, STEP_CELLS, strict=True)
            if 0 <= row + i < rows and 0 <= col + j < cols
        ]
        # Of equal neighbours the first by row and column, so that a replay goes the same way round.
        way.append(min(onward)[1])
    return way


def _hindrance(grid: OccupancyGrid, terrain: Terrain, goal: Cell) -> Hindrance:
    if not grid.spec.contains(*goal):
        return Hindrance.OUTSIDE
    # In this order from the outside inwards: the first that holds is what people can do something about.
    if terrain.allowed[goal]:
        return Hindrance.NO_WAY
    if terrain.free[goal]:
        return Hindrance.TOO_NEAR
    return Hindrance.UNKNOWN if grid.cells[goal] == NO_INFORMATION else Hindrance.OBSTACLE


def _nearest_reachable_m(terrain: Terrain, spec: GridSpec, here: Cell, goal_m: Point) -> Point | None:
    # Flooded from the robot's side, since from the goal there is no way.
    cells = np.argwhere(np.isfinite(terrain.ways_from(here)))
    if not cells.size:
        return None
    goal = spec.positions_at(np.array([goal_m]))[0] - 0.5
    row, col = cells[np.hypot(*(cells - goal).T).argmin()].tolist()
    return spec.centre_of(row, col)
