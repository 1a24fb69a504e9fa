"""Ways are free wherever the robot may be, and lead to where its places differ."""

import itertools
import math
import random

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.wall_field import WallField
from robotd.sensing.common_ground import CommonGround, Room
from robotd.sensing.rivals import Rival, SafeWay
from robotd.sensing.safe_ways import best_way

CELL_M = 0.05
ROBOT_M, CLEARANCE_M = 0.3, 0.1
SPEED_MPS = 0.4


def ground(cells: NDArray[np.bool_]) -> tuple[Room, WallField]:
    spec = GridSpec(CELL_M, 0.0, 0.0, (len(cells), len(cells[0])))
    return Room(spec, cells, ROBOT_M, CLEARANCE_M), WallField.of(spec, cells, cells)


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


def touches(cells: NDArray[np.bool_], pose: Pose2, way: SafeWay) -> bool:
    """Whether the robot's disk meets an obstacle somewhere along a way, beyond where it stands now: the slow twin."""
    rows, cols = np.nonzero(cells)
    for one, other in itertools.pairwise(((0.0, 0.0), *way.corners_m)):
        for share in np.linspace(0.0, 1.0, 2 + math.ceil(math.dist(one, other) / 0.02)):
            off = one[0] + share * (other[0] - one[0]), one[1] + share * (other[1] - one[1])
            x_m, y_m = pose.transform(*off)
            off_x = np.maximum(np.abs((cols + 0.5) * CELL_M - x_m) - CELL_M / 2, 0.0)
            off_y = np.maximum(np.abs((rows + 0.5) * CELL_M - y_m) - CELL_M / 2, 0.0)
            if math.hypot(*off) > 0.2 and np.hypot(off_x, off_y).min() < ROBOT_M:
                return True
    return False


def drivable(room: Room, *poses: Pose2) -> CommonGround:
    return CommonGround.of(room, rivals(*poses))


def test_it_drives_to_where_the_rooms_differ(twins: tuple[Room, WallField]) -> None:
    way = best_way(*twins, rivals(LEFT, RIGHT), 3.0, SPEED_MPS)
    assert way is not None
    # Ahead, to the door: only from there one looks far and the other does not.
    assert way.corners_m[-1][0] > 1.0
    assert way.told_apart > 0.1


def test_from_a_corner_it_goes_round_to_where_no_straight_leg_leads() -> None:
    cells = np.ones((120, 200), np.bool_)
    for left in (4, 104):  # two rooms, L-shaped; from the end of one's foot another shaft goes up
        cells[4:104, left : left + 30] = False
        cells[4:34, left : left + 90] = False
    cells[34:104, 64:94] = False
    room, walls = ground(cells)
    poses = [Pose2(0.95, 4.6, -math.pi / 2), Pose2(5.95, 4.6, -math.pi / 2)]
    way = best_way(room, walls, rivals(*poses), 1.5, SPEED_MPS)
    assert way is not None
    assert way.length_m == pytest.approx(3.0)  # no farther without another look
    assert way.rest_m > 1.0
    assert not any(touches(cells, pose, way) for pose in poses)
    poses = [Pose2(*pose.transform(*way.corners_m[-1]), pose.heading_rad) for pose in poses]
    onward = best_way(room, walls, rivals(*poses), 1.5, SPEED_MPS)
    assert onward is not None
    assert onward.told_apart >= 0.1
    assert onward.rest_m < 0.6
    assert len(onward.corners_m) > 1
    assert not any(touches(cells, pose, onward) for pose in poses)


def test_where_nothing_tells_apart_the_longest_way_is_driven(twins: tuple[Room, WallField]) -> None:
    room, walls = twins
    way = best_way(room, walls, rivals(LEFT, LEFT), 3.0, SPEED_MPS)
    assert way is not None
    assert way.told_apart == 0.0
    assert way.length_m == pytest.approx(3.0)
    ways_m = drivable(room, LEFT).ways_m
    assert way.length_m + way.rest_m > 0.9 * ways_m[np.isfinite(ways_m)].max()


def test_what_is_free_under_one_alone_is_not_driven(twins: tuple[Room, WallField]) -> None:
    room, walls = twins
    for turned_rad in (math.pi / 2, math.pi / 4, 0.0, -math.pi / 2):
        other = Pose2(6.6, 3.5, turned_rad)
        way = best_way(room, walls, rivals(LEFT, other), 3.0, SPEED_MPS)
        assert way is not None
        assert not any(touches(room.obstacles, pose, way) for pose in (LEFT, other))


def test_of_a_place_that_reaches_far_the_way_is_free_from_all_over_it(twins: tuple[Room, WallField]) -> None:
    room, walls = twins
    spots_m = tuple((2.2, y_m) for y_m in (1.0, 2.0, 3.2))
    way = best_way(room, walls, [Rival(LEFT, spots_m), *rivals(RIGHT)], 3.0, SPEED_MPS)
    assert way is not None
    assert not any(touches(room.obstacles, Pose2(*spot_m, LEFT.heading_rad), way) for spot_m in spots_m)


def test_what_lies_under_the_robot_does_not_keep_it_there(twins: tuple[Room, WallField]) -> None:
    room, walls = twins
    cells = room.obstacles.copy()
    cells[round(RIGHT.y_m / CELL_M) + 2, round(RIGHT.x_m / CELL_M)] = True
    way = best_way(ground(cells)[0], walls, rivals(LEFT, RIGHT), 3.0, SPEED_MPS)
    assert way is not None
    assert not touches(room.obstacles, RIGHT, way)


def test_a_robot_that_is_shut_in_stays() -> None:
    cells = np.ones((40, 60), np.bool_)
    cells[12:28, 12:28] = False
    cells[12:28, 34:50] = False
    assert best_way(*ground(cells), rivals(Pose2(1.0, 1.0, 0.0), Pose2(2.1, 1.0, 0.0)), 3.0, SPEED_MPS) is None


@pytest.mark.parametrize("seed", range(8))
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
    way = best_way(room, walls, rivals(*poses), 3.0, SPEED_MPS)
    if way is not None:
        assert way.length_m <= 3.0 + 1e-9
        assert not any(touches(cells, pose, way) for pose in poses)


@pytest.mark.parametrize("seed", range(4))
def test_the_ground_is_what_each_place_allows_cell_by_cell(seed: int) -> None:
    draw = random.Random(seed)
    cells = np.zeros((80, 80), np.bool_)
    for _ in range(6):
        cells[draw.randrange(80), draw.randrange(80)] = True
    room, _ = ground(cells)
    poses = [Pose2(draw.uniform(1.0, 3.0), draw.uniform(1.0, 3.0), draw.uniform(-3.1, 3.1)) for _ in range(2)]
    common = drivable(room, *poses)
    half = len(common.cells) // 2
    for _ in range(150):
        row, col = draw.randrange(half - 40, half + 41), draw.randrange(half - 40, half + 41)
        point = common.point_m((row, col))
        off_m = math.hypot(*point)
        if abs(off_m - 0.15) < 1e-6 or abs(off_m - 0.4) < 1e-6:
            continue  # on the edge of a rule
        allowed = off_m <= 0.15 or all(
            _allows(room.with_robot_at((pose.x_m, pose.y_m)), pose, point, off_m) for pose in poses
        )
        assert common.cells[row, col] == allowed


def _allows(room: Room, pose: Pose2, point: tuple[float, float], off_m: float) -> bool:
    cell, here = room.spec.cell_at(*pose.transform(*point)), room.spec.cell_at(pose.x_m, pose.y_m)
    is_crowded = off_m <= 0.4 and not room.clear[here]
    return bool(room.spec.contains(*cell) and (room.tight if is_crowded else room.clear)[cell])
