"""A robot's senses without the robot: a world mapped by sweeps, and readings of anybody who stands in it."""

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

from robotd.app.compose import head_settings
from robotd.config import Config
from robotd.core.grid_bytes import packed_cells
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.occupancy import OccupancyGrid
from robotd.head.desk import Desk
from robotd.head.job_table import perform
from robotd.head.jobs import MapRef, TakeMap
from robotd.sim.buildings.world import World
from robotd.sim.physics.walls import ray_cast

READINGS = 300
_MARGIN_M = 3.0
_SIGMA_M, _OUTLIERS = 0.02, 0.05
_NEAREST_M = 0.3
_STOP_M, _STOP_RAD = 0.01, math.radians(0.2)
"""How far off the stops of the map are."""
_ROBOT_M = 0.45
"""What is kept free round a robot that is put somewhere."""


@dataclass(frozen=True)
class Ground:
    """A mapped world."""

    world: World
    grid: OccupancyGrid
    desk: Desk
    map: MapRef
    cutoff_m: float

    @classmethod
    def of(cls, world: World, seed: int, cutoff_m: float = 6.0) -> "Ground":
        """Map a world from its stops, as well as a robot does that is placed at each."""
        draw, config = random.Random(f"{world.name}/{seed}/map"), Config()
        stops = [world.start_pose, *(Pose2(*stop_m, 0.0) for stop_m in world.stops_m)]
        spec = config.grid.spec_covering([(stop.x_m, stop.y_m) for stop in stops], _MARGIN_M)
        grid = OccupancyGrid(spec, settings=config.grid)
        bearings_rad = [math.tau * number / READINGS for number in range(READINGS)]
        for stop in stops:
            off = Pose2(draw.gauss(0, _STOP_M), draw.gauss(0, _STOP_M), draw.gauss(0, _STOP_RAD))
            grid.insert(Sweep(0, IDENTITY, readings_at(world, stop @ off, bearings_rad, cutoff_m, draw)), stop)
        desk, map_ref = Desk(head_settings(config)), MapRef(0)
        perform(desk, TakeMap(0, spec, memoryview(packed_cells(grid.cells)), config.grid))
        return cls(world, grid, desk, map_ref, cutoff_m)

    def somewhere(self, draw: random.Random) -> Pose2:
        """Return a pose where the robot fits, on ground that was seen."""
        spec = self.grid.spec
        while True:
            x_m = spec.origin_x_m + draw.random() * spec.cols * spec.resolution_m
            y_m = spec.origin_y_m + draw.random() * spec.rows * spec.resolution_m
            if self.fits(x_m, y_m):
                return Pose2(x_m, y_m, draw.uniform(-math.pi, math.pi))

    def fits(self, x_m: float, y_m: float) -> bool:
        """Whether the robot can stand there: all round it was seen free."""
        spec, cells = self.grid.spec, math.ceil(_ROBOT_M / self.grid.spec.resolution_m)
        row, col = spec.cell_at(x_m, y_m)
        if not (cells <= row < spec.rows - cells and cells <= col < spec.cols - cells):
            return False
        return bool((self.grid.cells[row - cells : row + cells + 1, col - cells : col + cells + 1] < 127).all())


def readings_at(
    world: World, pose: Pose2, bearings_rad: Sequence[float], cutoff_m: float, draw: random.Random
) -> tuple[RangeReading, ...]:
    """Return what a rangefinder measures: 2 cm of noise, one reading in twenty is wrong."""
    return tuple(_reading(world, pose, bearing_rad, cutoff_m, draw) for bearing_rad in bearings_rad)


def _reading(world: World, pose: Pose2, bearing_rad: float, cutoff_m: float, draw: random.Random) -> RangeReading:
    true_m = ray_cast(world.walls, (pose.x_m, pose.y_m), pose.heading_rad + bearing_rad)
    range_m = true_m + draw.gauss(0.0, _SIGMA_M)
    if draw.random() < _OUTLIERS:
        range_m = draw.uniform(_NEAREST_M, min(2.0 * true_m, 10.0))
    if range_m > cutoff_m:
        return RangeReading(0, bearing_rad, ReadingStatus.MISS, cutoff_m)
    if range_m < _NEAREST_M:
        return RangeReading(0, bearing_rad, ReadingStatus.TOO_NEAR, None)
    return RangeReading(0, bearing_rad, ReadingStatus.OK, range_m)
