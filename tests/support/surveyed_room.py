"""A room with furniture, and sweeps taken in it: what a survey of it is held against."""

import itertools
import math

import numpy as np

from robotd.core.grid_spec import GridSpec
from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.fit.refinement import expected_ranges

SPEC = GridSpec(0.05, -1.0, -1.0, (200, 260))
CUT_OFF_M = 6.0


def room() -> WallField:
    """Return 13 m x 10 m, divided by a wall with a door, with boxes in it that leave no place like another."""
    walls = np.ones(SPEC.shape, np.bool_)
    walls[6:-6, 6:-6] = False
    walls[6:150, 124:128] = True
    for row, col, height, width in ((20, 40, 12, 30), (90, 20, 30, 10), (150, 60, 8, 44), (40, 180, 36, 12)):
        walls[row : row + height, col : col + width] = True
    for row, col, height, width in ((120, 200, 10, 40), (100, 90, 8, 8), (70, 150, 8, 14), (160, 170, 16, 6)):
        walls[row : row + height, col : col + width] = True
    return WallField.of(SPEC, walls, walls)


def sweep_at(walls: WallField, pose: Pose2, random: np.random.Generator, beams: int = 300) -> Readings:
    """Return what a rangefinder reads all round: 1 cm of noise, one reading in fifty wrong, nothing beyond 6 m."""
    rows = np.zeros((beams, 5))
    rows[:, 0] = math.tau * np.arange(beams) / beams
    at = np.array([[pose.x_m, pose.y_m, pose.heading_rad]])
    ranges_m = expected_ranges(walls, Readings(rows), at, 1).ranges_m[0]
    wrong = random.random(beams) < 0.02
    ranges_m = np.where(wrong, ranges_m * random.uniform(0.3, 1.0, beams), ranges_m) + random.normal(0.0, 0.01, beams)
    rows[:, 4] = ranges_m > CUT_OFF_M
    rows[:, 1] = np.clip(ranges_m, 0.05, CUT_OFF_M)
    return Readings(rows)


def way_round(rounds: int = 1) -> list[Pose2]:
    """Return stops through both halves of the room and back, again and again."""
    corners = [
        (0.6, 1.3),
        (3.7, 1.6),
        (4.5, 4.5),
        (4.6, 7.4),
        (6.2, 8.3),
        (8.5, 8.3),
        (8.5, 6.6),
        (8.1, 3.6),
        (7.5, 2.0),
    ]
    corners += [(6.1, 1.2), (6.0, 4.6), (5.9, 7.9), (4.6, 7.6), (4.6, 5.4), (1.8, 5.4), (2.2, 2.6)]
    poses: list[Pose2] = []
    way = corners * rounds
    for (x_m, y_m), (to_x_m, to_y_m) in zip(way, [*way[1:], way[0]], strict=True):
        heading_rad = math.atan2(to_y_m - y_m, to_x_m - x_m)
        parts = max(1, round(math.hypot(to_x_m - x_m, to_y_m - y_m) / 1.2))
        for part in range(parts):
            share = part / parts
            poses.append(Pose2(x_m + share * (to_x_m - x_m), y_m + share * (to_y_m - y_m), heading_rad))
    return poses


def odometry_of(poses: list[Pose2], random: np.random.Generator) -> list[Travel]:
    """Return what wheels tell between stops: 5 % too long or short, 3 degrees a step off, and turning too far."""
    travels = []
    for one, other in itertools.pairwise(poses):
        step = one.inverse() @ other
        scale, turn = 1.0 + random.normal(0.0, 0.03), random.normal(math.radians(1.0), math.radians(2.0))
        told = Pose2(scale * step.x_m, scale * step.y_m, step.heading_rad + turn)
        travels.append(Travel(told, math.hypot(told.x_m, told.y_m), abs(told.heading_rad)))
    return travels
