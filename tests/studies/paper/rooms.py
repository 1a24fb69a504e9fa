"""The two rooms, and the five tests of [BrownDonald2000]_ sec. 3.2 in them.

The paper does not say where LILY stood, but how many of her probes were within range. Each test pose is therefore drawn
at random, until as many of its probes are within range of the true walls as in the paper: nothing else about a test is
chosen. The robot's planner must let it stand there, on the map it made: LILY could drive nowhere else. The simulated
office is less cluttered than the real one was: nowhere are all 8 probes within range, so there it is 7.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.planning.settings import PlanningSettings
from robotd.planning.traversable import free_cells, inflated
from robotd.sim.buildings.world import World, load_world
from robotd.sim.physics.walls import Point, WallSegments, clearance_m
from tests.studies.paper.robot import CUT_OFF_M, RANGE_MIN_M, ROBOT_RADIUS_M, true_ranges_m

_RESOLUTION_M = 0.05
_CELLS = 256
_CLEARANCE_M = ROBOT_RADIUS_M + 0.05


@dataclass(frozen=True)
class Room:
    """A room and where its map was made from."""

    name: str
    stops_m: tuple[Point, ...]
    """In the order of a tour along straight legs; the start comes before them. They were selected beforehand, the next
    always where most of the floor is seen for the first time by beams that meet something within range."""
    crop_cells: int
    """How much of the map the pictures show."""

    @cached_property
    def world(self) -> World:
        """Its walls."""
        return load_world(self.name)

    @property
    def spec(self) -> GridSpec:
        """256 x 256 cells of 50 mm with the room in the middle."""
        corners = np.concatenate([wall.points_m for wall in self.world.wall])
        x_m, y_m = ((corners.min(axis=0) + corners.max(axis=0)) / 2 - _CELLS / 2 * _RESOLUTION_M).tolist()
        return GridSpec(_RESOLUTION_M, x_m, y_m, (_CELLS, _CELLS))

    def poses(self, seed: int) -> Iterator[Pose2]:
        """Yield poses all over the free floor, with any heading."""
        random = np.random.default_rng(seed)
        walls = self.world.walls
        low, high = walls.starts_m.min(axis=0), walls.starts_m.max(axis=0)
        while True:
            x_m, y_m = random.uniform(low, high).tolist()
            heading_rad = random.uniform(-math.pi, math.pi)
            if is_inside(walls, (x_m, y_m)) and clearance_m(walls, (x_m, y_m)) >= _CLEARANCE_M:
                yield Pose2(x_m, y_m, heading_rad)


@dataclass(frozen=True, slots=True)
class Test:
    """One of the paper's tests, and what LILY's was."""

    number: int
    room: Room
    probes: int
    in_range: int
    consistent: int
    wanted: int
    """How many probes are to be within range here."""

    def pose_on(self, grid: OccupancyGrid) -> Pose2:
        """Return where the robot stands: the first fit of a random sequence that is seeded with the test's number."""
        floor = known_floor(grid)
        return next(
            pose
            for pose in self.room.poses(self.number)
            if floor[grid.spec.cell_at(pose.x_m, pose.y_m)] and self._in_range_at(pose) == self.wanted
        )

    def _in_range_at(self, pose: Pose2) -> int:
        ranges_m = true_ranges_m(self.room.world, pose, self.probes)
        return sum(RANGE_MIN_M <= range_m <= CUT_OFF_M for range_m in ranges_m)


def known_floor(grid: OccupancyGrid) -> NDArray[np.bool_]:
    """Return where the planner lets the robot stand on its map, ``bool[rows, cols]``."""
    radius_cells = ROBOT_RADIUS_M / grid.spec.resolution_m
    return ~inflated(~free_cells(grid, PlanningSettings().gap_cells), radius_cells, 0.0)


def is_inside(walls: WallSegments, point_m: Point) -> bool:
    """Return whether a point is in the room and in none of its furniture: a ray from it crosses an odd number of walls.

    Furniture along a wall has an edge in common with the room; the ray crosses both.
    """
    start = walls.starts_m - np.array(point_m)
    x, y = start.T
    along_x, along_y = walls.along_m.T
    crosses = (y > 0.0) != (y + along_y > 0.0)
    at_x = x - y * along_x / np.where(crosses, along_y, 1.0)
    return bool((crosses & (at_x > 0.0)).sum() % 2)


OFFICE = Room(
    "office", ((1.4, 0.8), (1.6, 2.2), (1.2, 2.2), (1.0, 3.2), (2.2, 3.0), (2.4, 2.6), (2.0, 2.2), (2.8, 1.2)), 128
)
LABORATORY = Room(
    "laboratory",
    (
        *((1.9, 1.6), (2.5, 0.7), (3.4, 1.6), (4.0, 1.6), (5.2, 0.7), (4.9, 1.6), (4.6, 2.5), (5.2, 2.8), (5.8, 3.4)),
        *((5.2, 4.0), (4.6, 4.3), (5.2, 5.2), (4.3, 5.2), (3.4, 4.9), (3.4, 6.4), (4.3, 7.0), (5.2, 7.3), (4.0, 7.3)),
        *((3.4, 7.3), (2.8, 7.0), (2.5, 7.3), (1.6, 8.2), (1.3, 4.6), (0.7, 5.5), (1.9, 5.8), (0.7, 3.7), (1.6, 2.8)),
        (0.7, 1.9),
    ),
    256,
)
TESTS = (
    Test(1, OFFICE, 8, 8, 7, 7),
    Test(2, OFFICE, 8, 8, 6, 7),
    Test(3, LABORATORY, 24, 7, 6, 7),
    Test(4, LABORATORY, 24, 10, 9, 10),
    Test(5, LABORATORY, 24, 11, 11, 11),
)
