"""Plans: free of collision, not longer than need be, and honest about what cannot be reached."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.contract.ways import Hindrance
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.planning.distance_field import distance_field
from robotd.planning.path import Path, Unreachable, plan
from robotd.planning.settings import PlanningSettings

SPEC = GridSpec(0.1, -1.0, -2.0, (30, 40))
SETTINGS = PlanningSettings(robot_radius_m=0.2, clearance_m=0.1)


def room(*boxes: tuple[float, float, float, float], inside: int = 255) -> OccupancyGrid:
    """Return a free floor with boxes ``(x_min, y_min, x_max, y_max)`` of one value on it."""
    cells = np.zeros(SPEC.shape, np.uint8)
    for x_min, y_min, x_max, y_max in boxes:
        low, high = SPEC.cell_at(x_min + 1e-9, y_min + 1e-9), SPEC.cell_at(x_max + 1e-9, y_max + 1e-9)
        cells[low[0] : high[0], low[1] : high[1]] = inside
    return OccupancyGrid(SPEC, cells)


WALL = room((1.0, -2.0, 1.2, 0.0))
START = Pose2(0.0, -1.0, 0.0)


def obstacle_centres(grid: OccupancyGrid) -> NDArray[np.float64]:
    """Return the centres of occupied cells, and of a rim of cells round the grid."""
    around = np.pad(grid.cells > 127, 1, constant_values=True)
    return np.array([grid.spec.centre_of(row - 1, col - 1) for row, col in np.argwhere(around)])


def clearance_m(path: Path, grid: OccupancyGrid) -> float:
    """Return how near the legs come to the centre of an obstacle's cell."""
    centres, nearest = obstacle_centres(grid), math.inf
    for (x0, y0), (x1, y1) in path.legs_m:
        for share in np.linspace(0.0, 1.0, 40):
            point = (x0 + share * (x1 - x0), y0 + share * (y1 - y0))
            nearest = min(nearest, float(np.hypot(*(centres - point).T).min()))
    return nearest


def test_an_open_floor_is_crossed_in_one_leg() -> None:
    path = plan(room(), START, (2.3, 0.4), SETTINGS)
    assert isinstance(path, Path)
    assert path.waypoints_m == ((2.3, 0.4),)
    assert path.legs_m == (((0.0, -1.0), (2.3, 0.4)),)
    assert path.length_m == pytest.approx(math.hypot(2.3, 1.4))


def test_a_wall_is_gone_round() -> None:
    path = plan(WALL, START, (2.0, -1.2), SETTINGS)
    assert isinstance(path, Path)
    assert path.waypoints_m[-1] == (2.0, -1.2)
    assert max(y_m for _, y_m in path.waypoints_m) > 0.2
    assert len(path.waypoints_m) <= 5
    assert clearance_m(path, WALL) > 0.25
    assert path.length_m < 4.5


def test_standing_on_the_goal_is_a_way_of_no_length() -> None:
    path = plan(room(), START, (0.0, -1.0), SETTINGS)
    assert isinstance(path, Path)
    assert (path.waypoints_m, path.length_m) == (((0.0, -1.0),), 0.0)


@pytest.mark.parametrize(
    ("grid", "goal_m", "hindrance"),
    [
        (room(), (9.0, 0.0), Hindrance.OUTSIDE),
        (WALL, (1.1, -1.0), Hindrance.OBSTACLE),
        (WALL, (1.4, -1.0), Hindrance.TOO_NEAR),
        (room((1.0, -2.0, 3.0, 1.0), inside=128), (2.0, -1.0), Hindrance.UNKNOWN),
        (room((1.0, -2.0, 1.2, 1.0)), (2.0, -1.0), Hindrance.NO_WAY),
    ],
)
def test_what_cannot_be_reached_is_said_with_the_nearest_point_that_can(
    grid: OccupancyGrid, goal_m: tuple[float, float], hindrance: Hindrance
) -> None:
    answer = plan(grid, START, goal_m, SETTINGS)
    assert isinstance(answer, Unreachable)
    assert answer.hindrance is hindrance
    assert answer.nearest_m is not None
    assert answer.hindrance is hindrance
    assert f"{answer.nearest_m[0]:.2f}" in answer.reason
    assert isinstance(plan(grid, START, answer.nearest_m, SETTINGS), Path)
    assert math.dist(answer.nearest_m, goal_m) < math.dist((0.0, -1.0), goal_m)


def test_a_robot_off_the_map_has_no_way() -> None:
    answer = plan(room(), Pose2(-5.0, 0.0, 0.0), (0.0, 0.0), SETTINGS)
    assert answer == Unreachable(Hindrance.START_OUTSIDE, None)
    assert answer.reason == "the robot stands outside the map"


def test_a_robot_walled_in_cannot_move_at_all() -> None:
    around = room((-1.0, -2.0, 3.0, 1.0))
    around.cells[SPEC.cell_at(0.0, -1.0)] = 0
    answer = plan(around, START, (2.0, 0.0), SETTINGS)
    assert isinstance(answer, Unreachable)
    assert answer.nearest_m is None


def test_a_robot_too_near_to_a_wall_leaves_it_first() -> None:
    beside = Pose2(0.85, -1.0, 0.0)
    path = plan(WALL, beside, (0.0, 0.5), SETTINGS)
    assert isinstance(path, Path)
    (x_m, y_m), *_ = path.waypoints_m
    assert 0.6 < x_m < 0.8
    assert abs(y_m + 1.0) < 0.2
    assert clearance_m(Path((x_m, y_m), path.waypoints_m[1:]), WALL) > 0.25


def test_a_robot_in_a_narrow_niche_leaves_it_by_the_mouth_and_not_through_the_wall() -> None:
    niche = room((-0.3, -2.0, -0.2, -0.9), (0.2, -2.0, 0.3, -0.9))
    wide = PlanningSettings(robot_radius_m=0.15, clearance_m=0.35)
    path = plan(niche, Pose2(0.0, -1.3, 0.0), (2.0, -1.0), wide)
    assert isinstance(path, Path)
    (x_m, y_m), *_ = path.waypoints_m
    assert abs(x_m) < 0.2
    assert y_m > -0.6


def test_the_ground_under_the_robot_is_free_though_nobody_saw_it() -> None:
    unseen = room((-0.3, -1.3, 0.3, -0.7), inside=128)
    assert isinstance(plan(unseen, START, (2.0, 0.0), SETTINGS), Path)


CORRIDOR = room((-1.0, -2.0, 3.0, -1.5), (-1.0, -0.5, 3.0, 1.0))


@pytest.mark.parametrize(("values", "passes"), [((200,), True), ((244,), False), ((200, 200), False)])
def test_only_where_nothing_leads_round_a_lone_hit_is_taken_for_a_wrong_range(
    values: tuple[int, ...], passes: bool
) -> None:
    row, col = SPEC.cell_at(1.0, -1.0)
    grid = OccupancyGrid(SPEC, CORRIDOR.cells)
    grid.cells[row, col : col + len(values)] = values
    assert isinstance(plan(grid, START, (2.3, -1.0), SETTINGS), Path) == passes
    open_floor = room()
    open_floor.cells[row, col : col + len(values)] = values
    path = plan(open_floor, START, (2.3, -1.0), SETTINGS)
    assert isinstance(path, Path)
    assert clearance_m(path, open_floor) > 0.25


def test_a_lone_hit_at_the_goal_is_not_doubted() -> None:
    grid = OccupancyGrid(SPEC, CORRIDOR.cells)
    grid.cells[SPEC.cell_at(2.0, -1.0)] = 200
    answer = plan(grid, START, (2.02, -0.98), SETTINGS)
    assert isinstance(answer, Unreachable)
    assert answer.hindrance is Hindrance.OBSTACLE


fields = hnp.arrays(np.uint8, SPEC.shape, elements=st.sampled_from([0] * 60 + [255]), fill=st.just(0))
starts = st.tuples(st.floats(-0.6, 2.6), st.floats(-1.6, 0.6))


def fits_at(centres_m: NDArray[np.float64], radius_m: float) -> bool:
    """Whether no obstacle's centre is too near, and from nowhere in the cell the disk meets an obstacle's square."""
    squares_m = np.maximum(np.abs(centres_m) - SPEC.resolution_m / 2, 0.0)
    is_clear = np.hypot(*squares_m.T).min() > SETTINGS.robot_radius_m + math.sqrt(0.5) * SPEC.resolution_m
    return bool(np.hypot(*centres_m.T).min() > radius_m + 1e-9 and is_clear)


@settings(max_examples=60, deadline=None)
@given(fields, starts, starts)
def test_a_plan_keeps_its_distance_and_there_is_one_exactly_if_the_ground_allows(
    cells: NDArray[np.uint8], start: tuple[float, float], goal: tuple[float, float]
) -> None:
    grid = OccupancyGrid(SPEC, cells)
    here, there = SPEC.cell_at(*start), SPEC.cell_at(*goal)
    cells[tuple(slice(part - 3, part + 4) for part in here)] = 0  # as where a robot stands
    grid = OccupancyGrid(SPEC, cells)
    radius_m = SETTINGS.robot_radius_m + SETTINGS.clearance_m
    centres = obstacle_centres(grid)
    allowed = np.array(
        [
            [fits_at(centres - SPEC.centre_of(row, col), radius_m) for col in range(SPEC.cols)]
            for row in range(SPEC.rows)
        ]
    )
    answer = plan(grid, Pose2(*start, 0.0), goal, SETTINGS)
    assert isinstance(answer, Path) == bool(allowed[here] and np.isfinite(distance_field(allowed, there)[here]))
    if isinstance(answer, Path):
        assert clearance_m(answer, grid) > radius_m - SPEC.resolution_m
        assert answer.length_m <= (distance_field(allowed, there)[here] + 2.0) * SPEC.resolution_m


@pytest.mark.parametrize("bad", [{"robot_radius_m": 0.0}, {"clearance_m": -0.1}, {"gap_cells": -1}])
def test_impossible_settings_are_refused_by_name(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        PlanningSettings(**bad)  # type: ignore[arg-type]  # wrong on purpose
