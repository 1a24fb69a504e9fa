"""What stops a beam, and what nobody has seen."""

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.exploring.charted import Charted
from robotd.exploring.settings import ExploringSettings
from robotd.grid.kernels.cast.cast_kernel import BLOCKS, ENDS
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.planning.terrain import Terrain
from robotd.planning.traversable import lone_hits
from tests.unit.exploring.maps import FREE, ROBOT, WALL, grid_of, question

HIT_ONCE = 166
START_M = (0.75, 2.05)


def room(*hits: tuple[int, int]) -> NDArray[np.uint8]:
    """Return a room with walls to the west, north and south, whose east nobody has seen; with some single hits."""
    cells = np.full((41, 40), NO_INFORMATION, np.uint8)
    cells[:, :20] = FREE
    cells[[0, -1], :20] = cells[:, 0] = WALL
    for cell in hits:
        cells[cell] = HIT_ONCE
    return cells


def charted(grid: OccupancyGrid) -> Charted:
    hit = grid.cells == HIT_ONCE
    lone = lone_hits(grid, hit)
    assert lone.sum() == hit.sum()
    ground = Terrain.of(grid, question(START_M).start, hit, lone, ROBOT)
    return Charted.of(grid, hit, lone, ground, robot=START_M, within=None, cut_off_m=3.5, settings=ExploringSettings())


def stops_eastward(known: Charted) -> set[int]:
    """Return what stops beams that leave the start for the border between seen and unseen ground."""
    bearings_rad = np.arange(-0.8, 0.8, 0.02)
    ahead = np.stack((np.cos(bearings_rad), np.sin(bearings_rad)), axis=1)
    _, stops = known.outlook._cast(np.array([START_M]), ahead)
    return set(stops[0].tolist())


def test_a_row_of_single_hits_is_a_wall_and_nothing_leads_through() -> None:
    known = charted(grid_of(room(*((row, 20) for row in range(2, 40, 3)))))
    assert stops_eastward(known) == {ENDS}
    assert known.unknown[20, 25]
    views = known.outlook.views(np.array([START_M]), ExploringSettings())
    assert (views.area_m2[0], views.opening_m[0]) == (0.0, 0.0)


def test_without_them_there_is_much_to_see() -> None:
    known = charted(grid_of(room()))
    assert stops_eastward(known) == {BLOCKS}
    assert known.outlook.views(np.array([START_M]), ExploringSettings()).area_m2[0] > 4.0


@pytest.mark.parametrize("door", [9, 12])
def test_a_door_between_them_stays_open(door: int) -> None:
    known = charted(grid_of(room(*((row, 20) for row in range(2, 40, 3) if abs(row - 20) > door / 2))))
    views = known.outlook.views(np.array([START_M]), ExploringSettings())
    assert views.area_m2[0] > ExploringSettings().good_enough_max_m2


def test_a_wrong_range_in_the_air_hides_nothing() -> None:
    known = charted(grid_of(room((20, 15))))
    assert stops_eastward(known) == {BLOCKS}
