"""Legs are free wherever the robot may be, and lead to where its places differ."""

import math
import random

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.wall_field import WallField
from robotd.planning.traversable import inflated
from robotd.sensing.rivals import Leg, Rival
from robotd.sensing.safe_legs import Room, best_leg

CELL_M = 0.05
ROBOT_M, CLEARANCE_M = 0.3, 0.1
SPEED_MPS = 0.4


def ground(cells: NDArray[np.bool_]) -> tuple[Room, WallField]:
    spec = GridSpec(CELL_M, 0.0, 0.0, (len(cells), len(cells[0])))
    tight = ~inflated(cells, ROBOT_M / CELL_M, 0.0)
    clear = ~inflated(cells, ROBOT_M / CELL_M, CLEARANCE_M / CELL_M)
    return Room(spec, tight, clear), WallField.of(spec, cells, cells)


@pytest.fixture(scope="module")
def twins() -> tuple[Room, WallField]:
    """Two rooms, 4 m x 4 m, alike; the door of the left one leads into a hall, that of the right one is walled up."""
    cells = np.ones((200, 180), np.bool_)
    cells[4:84, 4:84] = False
    cells[4:84, 92:172] = False
    cells[84:196, 30:58] = False
    cells[84:96, 118:146] = False
    return ground(cells)


LEFT = Pose2(2.2, 1.0, math.pi / 2)
RIGHT = Pose2(6.6, 1.0, math.pi / 2)


def rivals(*poses: Pose2) -> list[Rival]:
    return [Rival(pose, ((pose.x_m, pose.y_m),)) for pose in poses]


def touches(cells: NDArray[np.bool_], pose: Pose2, leg: Leg) -> bool:
    """Whether the robot's disk meets an obstacle somewhere along a leg, beyond where it stands now: the slow twin."""
    rows, cols = np.nonzero(cells)
    length_m = math.hypot(leg.x_m, leg.y_m)
    for way_m in np.arange(0.2, length_m + 0.01, 0.02):
        x_m, y_m = pose.transform(leg.x_m * way_m / length_m, leg.y_m * way_m / length_m)
        off_x = np.maximum(np.abs((cols + 0.5) * CELL_M - x_m) - CELL_M / 2, 0.0)
        off_y = np.maximum(np.abs((rows + 0.5) * CELL_M - y_m) - CELL_M / 2, 0.0)
        if np.hypot(off_x, off_y).min() < ROBOT_M:
            return True
    return False


def test_it_drives_to_where_the_rooms_differ(twins: tuple[Room, WallField]) -> None:
    leg = best_leg(*twins, rivals(LEFT, RIGHT), 3.0, SPEED_MPS)
    assert leg is not None
    # Ahead, to the door: only from there one looks far and the other does not.
    assert leg.x_m > 1.0
    assert leg.told_apart > 0.1


def test_where_nothing_tells_apart_the_longest_free_leg_is_driven(twins: tuple[Room, WallField]) -> None:
    leg = best_leg(*twins, rivals(LEFT, RIGHT), 0.6, SPEED_MPS)
    assert leg is not None
    assert leg.told_apart < 0.05
    assert math.hypot(leg.x_m, leg.y_m) == pytest.approx(3.0)


def test_what_is_free_under_one_alone_is_not_driven(twins: tuple[Room, WallField]) -> None:
    room, walls = twins
    against_the_wall = Pose2(6.6, 3.5, 0.0)
    assert room.is_free((LEFT.x_m, LEFT.y_m), LEFT.heading_rad, 3.0)
    for turned_rad in (math.pi / 2, math.pi / 4, 0.0, -math.pi / 2):
        other = Pose2(against_the_wall.x_m, against_the_wall.y_m, turned_rad)
        leg = best_leg(room, walls, rivals(LEFT, other), 3.0, SPEED_MPS)
        assert leg is not None
        length_m, to_side_rad = math.hypot(leg.x_m, leg.y_m), math.atan2(leg.y_m, leg.x_m)
        assert room.is_free((other.x_m, other.y_m), other.heading_rad + to_side_rad, length_m)
        assert room.is_free((LEFT.x_m, LEFT.y_m), LEFT.heading_rad + to_side_rad, length_m)


def test_of_a_place_that_reaches_far_the_leg_is_free_from_all_over_it(twins: tuple[Room, WallField]) -> None:
    room, walls = twins
    spots_m = tuple((2.2, y_m) for y_m in (1.0, 2.0, 3.2))
    leg = best_leg(room, walls, [Rival(LEFT, spots_m), *rivals(RIGHT)], 3.0, SPEED_MPS)
    assert leg is not None
    heading_rad = LEFT.heading_rad + math.atan2(leg.y_m, leg.x_m)
    assert all(room.is_free(spot_m, heading_rad, math.hypot(leg.x_m, leg.y_m)) for spot_m in spots_m)


def test_a_robot_that_is_shut_in_stays() -> None:
    cells = np.ones((40, 60), np.bool_)
    cells[12:28, 12:28] = False
    cells[12:28, 34:50] = False
    assert best_leg(*ground(cells), rivals(Pose2(1.0, 1.0, 0.0), Pose2(2.1, 1.0, 0.0)), 3.0, SPEED_MPS) is None


@pytest.mark.parametrize("seed", range(12))
def test_on_random_ground_the_robot_touches_nothing_wherever_it_stands(seed: int) -> None:
    draw = random.Random(seed)
    cells = np.ones((120, 120), np.bool_)
    cells[3:-3, 3:-3] = False
    for _ in range(8):
        row, col = draw.randrange(110), draw.randrange(110)
        cells[row : row + draw.randrange(1, 12), col : col + draw.randrange(1, 12)] = True
    room, walls = ground(cells)
    free = np.argwhere(room.clear)
    places = [free[draw.randrange(len(free))] for _ in range(3)]
    poses = [Pose2((col + 0.5) * CELL_M, (row + 0.5) * CELL_M, draw.uniform(-3.1, 3.1)) for row, col in places]
    leg = best_leg(room, walls, rivals(*poses), 3.0, SPEED_MPS)
    if leg is not None:
        assert not any(touches(cells, pose, leg) for pose in poses)
