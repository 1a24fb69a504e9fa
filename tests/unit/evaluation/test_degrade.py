"""Maps made worse: each kind does what its name says, and poses stay where the walls went."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.evaluation.degrade import KINDS, degrade
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION

SPEC = GridSpec(0.05, -1.0, 0.5, (60, 80))


@pytest.fixture
def room() -> OccupancyGrid:
    cells = np.full(SPEC.shape, NO_INFORMATION, np.uint8)
    cells[10:50, 10:70] = 3
    cells[10:50, 10] = cells[10:50, 69] = cells[10, 10:70] = cells[49, 10:70] = 250
    cells[30, 40:44] = 150
    return OccupancyGrid(SPEC, cells)


def walls(grid: OccupancyGrid) -> int:
    return int((grid.cells > NO_INFORMATION).sum())


def test_thicker_walls_hold_the_old_ones(room: OccupancyGrid) -> None:
    found = [degrade(f"thicker-{cells}", room, 0).grid for cells in (1, 2, 3)]
    assert [walls(grid) for grid in found] == sorted(walls(grid) for grid in found)
    assert all((grid.cells[room.cells > NO_INFORMATION] == 255).all() for grid in found)
    assert (found[0].cells[10, 9:12] == 255).all()


def test_thinned_walls_are_left_of_thick_ones(room: OccupancyGrid) -> None:
    thick = degrade("thicker-2", room, 0).grid
    thin = degrade("thinned", thick, 0).grid
    assert 0 < walls(thin) < walls(thick) / 2
    assert ((thin.cells > NO_INFORMATION) <= (thick.cells > NO_INFORMATION)).all()


def test_a_coarse_wall_stands_where_a_fine_one_did(room: OccupancyGrid) -> None:
    for kind, by in (("coarse-100mm", 2), ("coarse-200mm", 4)):
        coarse = degrade(kind, room, 0).grid
        assert coarse.spec.resolution_m == pytest.approx(by * 0.05)
        for row, col in np.argwhere(room.cells > NO_INFORMATION):
            assert coarse.cells[coarse.spec.cell_at(*SPEC.centre_of(row, col))] > NO_INFORMATION


def test_three_greys_are_left(room: OccupancyGrid) -> None:
    found = degrade("trinary", room, 0).grid
    assert set(np.unique(found.cells)) == {1, NO_INFORMATION, 255}
    assert found.cells[30, 41] == NO_INFORMATION  # 150 is too weak for a wall


def test_unknown_becomes_free(room: OccupancyGrid) -> None:
    found = degrade("unknown-free", room, 0).grid
    assert (found.cells != NO_INFORMATION).all()
    assert walls(found) == walls(room)


def test_furniture_is_moved_the_same_way_by_the_same_seed(room: OccupancyGrid) -> None:
    one, again, other = (degrade("refurnished", room, seed).grid.cells for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, again)
    assert (one != other).any()
    gone = (room.cells > NO_INFORMATION) & (one < NO_INFORMATION)
    assert 0.02 < gone.sum() / walls(room) < 0.5
    assert ((room.cells < NO_INFORMATION) & (one > NO_INFORMATION)).sum() > 100


@given(row=st.integers(12, 47), col=st.integers(12, 67), kind=st.sampled_from(["turned-30deg", "scaled-1percent"]))
def test_a_pose_goes_where_its_cell_goes(row: int, col: int, kind: str) -> None:
    cells = np.full(SPEC.shape, NO_INFORMATION, np.uint8)
    cells[row - 1 : row + 2, col - 1 : col + 2] = 250
    worse = degrade(kind, OccupancyGrid(SPEC, cells), 0)
    x_m, y_m = SPEC.centre_of(row, col)
    there = worse.pose(Pose2(x_m, y_m, 0.3))
    assert worse.grid.cells[worse.grid.spec.cell_at(there.x_m, there.y_m)] == 250
    assert there.heading_rad == pytest.approx(0.3 + (0.5235987755982988 if "turned" in kind else 0.0))


@pytest.mark.parametrize("kind", KINDS)
def test_the_map_itself_stays_as_it_is(kind: str, room: OccupancyGrid) -> None:
    before = room.digest()
    degrade(kind, room, 0)
    assert room.digest() == before
