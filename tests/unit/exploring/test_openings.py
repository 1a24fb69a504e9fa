"""What is left open: stretches of the border between seen and unseen, and nothing behind a wall."""

import numpy as np

from robotd.core.rectangle import Rectangle
from robotd.exploring.openings import Opening, openings
from robotd.exploring.outlook import extent_of
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from tests.unit.exploring.maps import at, drawn, grid_of


def found(grid: OccupancyGrid, within: Rectangle | None = None, width_min_m: float = 0.4) -> tuple[Opening, ...]:
    free, unknown = grid.cells < NO_INFORMATION, grid.cells == NO_INFORMATION
    robot = grid.spec.cell_at(*at(2, 2))
    near = np.zeros_like(free)
    near[:, :12] = True
    return openings(
        grid.spec,
        free,
        unknown,
        near,
        robot=robot,
        within=within or extent_of(grid.spec),
        width_min_m=width_min_m,
    )


ROOM = (
    "########",
    "#...... ",
    "#...... ",
    " ......#",
    "#......#",
    "########",
)


def test_each_opening_is_named_once_the_widest_first() -> None:
    wide, narrow = found(drawn(*ROOM), width_min_m=0.2)
    assert wide.at_m[0] > 1.9
    assert 0.55 <= wide.width_m <= 0.75
    assert not wide.is_near
    assert narrow.at_m[0] < 0.5
    assert narrow.is_near


def test_what_is_too_narrow_is_none() -> None:
    assert len(found(drawn(*ROOM))) == 1


def test_what_lies_beyond_the_bounds_is_left_out() -> None:
    assert found(drawn(*ROOM), Rectangle(0.0, 0.0, 1.8, 1.8)) == ()


def test_a_strip_that_a_wrong_range_left_behind_a_wall_is_no_opening() -> None:
    cells = drawn(*("   " + line.replace(" ", "#") + "   " for line in ROOM)).cells.copy()
    cells[8, 20:33] = 5  # through the east wall, and on where nobody can look
    cells[6:11, 33] = 5
    assert found(grid_of(cells)) == ()
