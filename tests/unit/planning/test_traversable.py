"""What the robot may drive over, against definitions cell by cell, and drawn."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.spec import GridSpec
from robotd.planning.traversable import closed, free_cells, inflated, strays

masks = hnp.arrays(np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=9))
VALUES = {"#": 244, "!": 217, "?": 128, ".": 3}


def grid_of(*rows: str) -> OccupancyGrid:
    """Return a grid drawn top row first: ``#`` a sure obstacle, ``!`` one hit, ``?`` never seen, ``.`` free."""
    cells = np.array([[VALUES[cell] for cell in row] for row in reversed(rows)], np.uint8)
    return OccupancyGrid(GridSpec(1.0, 0.0, 0.0, (len(rows), len(rows[0]))), cells)


def drawn(free: NDArray[np.bool_]) -> list[str]:
    return ["".join(".#"[not cell] for cell in row) for row in reversed(free.tolist())]


@settings(max_examples=80)
@given(masks, st.integers(0, 4))
def test_closing_fills_what_no_square_outside_the_set_covers(mask: NDArray[np.bool_], gap: int) -> None:
    rows, cols = mask.shape
    expected = np.ones_like(mask)
    for top in range(-gap, rows):
        for left in range(-gap, cols):
            square = (slice(max(0, top), top + gap + 1), slice(max(0, left), left + gap + 1))
            if not mask[square].any():
                expected[square] = False
    assert np.array_equal(closed(mask, gap), expected)
    assert (closed(mask, gap) >= mask).all()


@settings(max_examples=80)
@given(masks, st.floats(0.0, 4.0))
def test_inflated_is_what_is_too_near_an_obstacle_or_the_edge(mask: NDArray[np.bool_], radius: float) -> None:
    rows, cols = mask.shape
    around = np.pad(mask, 5, constant_values=True)
    obstacles = np.argwhere(around) - 5
    for row, col in np.ndindex(rows, cols):
        near = (np.hypot(*(obstacles - (row, col)).T) <= radius + 1e-9).any()
        assert inflated(mask, radius)[row, col] == near


def test_wedges_between_beams_are_closed_and_open_ground_is_not() -> None:
    grid = grid_of(
        "..?..??????",
        "..?..??????",
        "...?.??????",
        "...??.?????",
        "...........",
    )
    assert drawn(free_cells(grid, 2)) == [
        ".....######",
        ".....######",
        ".....######",
        "......#####",
        "...........",
    ]


def test_no_wall_is_eaten_not_even_a_thin_one() -> None:
    grid = grid_of(
        "....#....",
        "....#....",
        "....!....",
        "....#....",
        "....#....",
    )
    assert drawn(free_cells(grid, 2)) == ["....#...."] * 5


def test_one_hit_in_the_open_is_a_stray_until_it_is_confirmed() -> None:
    once, twice = (grid_of(".....", ".....", f"..{mark}..", ".....", ".....") for mark in "!#")
    assert free_cells(once, 2).all()
    assert np.argwhere(~free_cells(twice, 2)).tolist() == [[2, 2]]


def test_two_hits_side_by_side_are_an_obstacle() -> None:
    grid = grid_of(".....", ".!...", "..!..", ".....")
    assert not strays(grid).any()
    assert (~free_cells(grid, 2)).sum() == 2


@given(hnp.arrays(np.uint8, (7, 8), elements=st.sampled_from([0, 3, 127, 128, 129, 200, 217, 218, 255])))
def test_a_stray_has_no_occupied_neighbour_and_little_evidence(cells: NDArray[np.uint8]) -> None:
    found = strays(OccupancyGrid(GridSpec(1.0, 0.0, 0.0, (7, 8)), cells))
    for row, col in np.ndindex(7, 8):
        around = cells[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2]
        assert found[row, col] == (128 < cells[row, col] <= 217 and (around > 128).sum() == 1)
