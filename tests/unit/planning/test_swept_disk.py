"""The robot's disk, swept along every leg of a plan, meets nothing that the planner takes for an obstacle.

The oracle knows nothing of the planner's geometry: it puts the disk down at very many points of each leg, as very many
points of its own, and looks up the cell under each.
"""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.planning.path import Path, plan
from robotd.planning.settings import PlanningSettings

_SHRUNK = 1.0 - 1e-6
"""The disk's rim may touch."""


def disk_points(radius_m: float) -> NDArray[np.float64]:
    """Return points of a disk round the origin, its rim among them, ``float64[n, 2]``."""
    angles = np.linspace(0.0, math.tau, 128, endpoint=False)
    rings = [
        radius_m * share * np.stack((np.cos(angles), np.sin(angles)), axis=1)
        for share in (_SHRUNK, *np.arange(0.1, 1.0, 0.1))
    ]
    return np.concatenate([np.zeros((1, 2)), *rings])


def cells_met(grid: OccupancyGrid, path: Path, radius_m: float) -> set[tuple[int, int]]:
    """Return the occupied cells that the disk meets on the way, by sampling."""
    found: set[tuple[int, int]] = set()
    disk = disk_points(radius_m)
    for one, other in path.legs_m:
        steps = max(2, math.ceil(math.dist(one, other) / (0.2 * grid.spec.resolution_m)))
        shares = np.linspace(0.0, 1.0, steps)[:, None]
        centres = np.array(one) + shares * (np.array(other) - np.array(one))
        flat = np.unique(grid.spec.flat_at((centres[:, None, :] + disk).reshape(-1, 2)))
        flat = flat[flat >= 0]
        found |= {divmod(int(cell), grid.spec.cols) for cell in flat[grid.cells.reshape(-1)[flat] > 127]}
    return found


def random_case(seed: int) -> tuple[OccupancyGrid, Pose2, tuple[float, float], PlanningSettings]:
    random = np.random.default_rng(seed)
    resolution_m = float(random.choice([0.05, 0.1, 0.2]))
    shape = int(random.integers(20, 50)), int(random.integers(20, 50))
    cells = np.zeros(shape, np.uint8)
    cells[random.random(shape) < random.choice([0.002, 0.01, 0.03])] = 255
    for _ in range(int(random.integers(0, 4))):
        row, col = int(random.integers(0, shape[0])), int(random.integers(0, shape[1]))
        cells[row : row + int(random.integers(1, 12)), col : col + int(random.integers(1, 12))] = 230
    spec = GridSpec(resolution_m, -1.0, 0.5, shape)
    extent_m = np.array([shape[1], shape[0]]) * resolution_m
    (x0, y0), (x1, y1) = np.array([-1.0, 0.5]) + random.random((2, 2)) * extent_m
    settings = PlanningSettings(
        robot_radius_m=float(random.uniform(0.5, 4.0)) * resolution_m,
        clearance_m=float(random.choice([0.0, 0.25, 0.5, 0.75, 1.0, 2.0])) * resolution_m,
    )
    return OccupancyGrid(spec, cells), Pose2(float(x0), float(y0), 0.0), (float(x1), float(y1)), settings


def test_no_leg_takes_the_disk_into_an_obstacle_900_maps() -> None:
    planned = 0
    for seed in range(900):
        grid, start, goal_m, settings = random_case(seed)
        path = plan(grid, start, goal_m, settings)
        if not isinstance(path, Path):
            continue
        planned += 1
        stands_in = cells_met(grid, Path((start.x_m, start.y_m), ((start.x_m, start.y_m),)), settings.robot_radius_m)
        met = cells_met(grid, path, settings.robot_radius_m)
        assert met <= stands_in, f"case {seed}: {sorted(met - stands_in)}"
        assert path.waypoints_m[-1] == goal_m
    assert planned > 300


@pytest.mark.parametrize("clearance_cells", [0.0, 0.5])
def test_a_doorway_that_is_wide_enough_is_passed(clearance_cells: float) -> None:
    """Free by construction, but no narrower than that takes: a cell and a half on either side is enough."""
    cells = np.zeros((30, 30), np.uint8)
    cells[:, 15] = 255
    cells[10:17, 15] = 0
    grid = OccupancyGrid(GridSpec(0.1, 0.0, 0.0, (30, 30)), cells)
    settings = PlanningSettings(robot_radius_m=0.2, clearance_m=0.1 * clearance_cells)
    assert isinstance(plan(grid, Pose2(0.7, 0.7, 0.0), (2.3, 2.3), settings), Path)


def test_the_last_bit_of_the_way_is_swept_too() -> None:
    """The goal is a point, not the centre of its cell, and the start likewise."""
    for seed in range(900, 1000):
        grid, start, goal_m, settings = random_case(seed)
        path = plan(grid, start, goal_m, settings)
        if isinstance(path, Path):
            end = Path(path.waypoints_m[-1], (path.waypoints_m[-1],))
            here = Path(path.start_m, (path.start_m,))
            assert cells_met(grid, end, settings.robot_radius_m) <= cells_met(grid, here, settings.robot_radius_m)
