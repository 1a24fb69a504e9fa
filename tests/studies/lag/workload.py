"""What the daemon is given to do: maps of 8192 x 8192 cells, and an estimate of 32 large regions."""

import math

import numpy as np
from numpy.typing import NDArray

from robotd.contract.estimate import Circle, Cover, Extent, PoseEstimate, PoseState, Region
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid

LARGE_CELLS = 8192
REGIONS = 32
_RUNS = 32
_READINGS = 300


def large_grid() -> OccupancyGrid:
    """Return a map of the largest size: rooms of 6 m, and in each some cells that no beam or many met."""
    random = np.random.default_rng(0)
    cells: NDArray[np.uint8] = np.full((LARGE_CELLS, LARGE_CELLS), 20, np.uint8)
    cells[::120] = cells[:, ::120] = 230
    cells[random.random(cells.shape) < 0.02] = 127
    side_m = LARGE_CELLS * 0.05
    return OccupancyGrid(GridSpec(0.05, -side_m / 2, -side_m / 2, cells.shape), cells)


def large_estimate(time_ns: int, *, final: bool) -> PoseEstimate:
    """Return an estimate of 32 regions, each ragged and described in full."""
    return PoseEstimate(
        time_ns=time_ns,
        state=PoseState.AMBIGUOUS,
        best=None,
        regions=tuple(_region(number) for number in range(REGIONS)),
        best_rank=280,
        readings=_READINGS,
        final=final,
        map_id="large",
        regions_left_out=7,
        belief_aside=0.01,
        belief_nowhere=0.02,
        contrast=1.5,
        bearings_rad=tuple(math.tau * number / _READINGS for number in range(_READINGS)),
    )


def _region(number: int) -> Region:
    x_m = 12.0 * number + 1 / 3
    return Region(
        belief=1.0 / REGIONS,
        pose=Pose2(x_m, 2 / 3, 0.1),
        covariance=((1 / 7, 0.0, 1 / 9), (0.0, 1 / 7, 0.0), (1 / 9, 0.0, 1 / 11)),
        residual_m=1 / 70,
        centre=Pose2(x_m, 2 / 3, 0.2),
        extent=Extent(x_m - 2, x_m + 2, -2.0, 2.0, -0.3, 0.3),
        circle=Circle(x_m, 0.0, 2.1),
        cover=Cover(1, tuple((row, 240 * number + row % 7, 240 * number + 40 + row % 5) for row in range(_RUNS))),
        cells=1200,
        poses=9000,
        best_rank=280 - number % 3,
        explained=tuple((reading * (number + 3)) % 11 != 0 for reading in range(_READINGS)),
    )
