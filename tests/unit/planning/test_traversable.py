"""What the robot may drive over, against definitions cell by cell, and drawn."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.planning.traversable import closed, free_cells, inflated, lone_hits

masks = hnp.arrays(np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=9))
NO_HITS = np.zeros((5, 5), np.bool_)
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
@given(masks, st.floats(0.0, 3.0), st.floats(0.0, 2.0))
def test_inflated_is_what_is_too_near_an_obstacle_or_the_edge(
    mask: NDArray[np.bool_], robot: float, clearance: float
) -> None:
    rows, cols = mask.shape
    around = np.pad(mask, 7, constant_values=True)
    obstacles = np.argwhere(around) - 7
    found = inflated(mask, robot, clearance)
    for row, col in np.ndindex(rows, cols):
        off = np.abs(obstacles - (row, col))
        is_near = (np.hypot(*off.T) <= robot + clearance).any()
        is_met = (np.hypot(*np.maximum(off - 0.5, 0.0).T) < robot + math.sqrt(0.5) + 1e-6).any()
        assert found[row, col] == (is_near or is_met)


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


def test_one_hit_in_the_open_is_an_obstacle_unless_it_is_doubted() -> None:
    """The leg of a table is one cell, hit once, and looks like a wrong range."""
    once, twice = (grid_of(".....", ".....", f"..{mark}..", ".....", ".....") for mark in "!#")
    for grid in (once, twice):
        assert np.argwhere(~free_cells(grid, 2)).tolist() == [[2, 2]]
    assert free_cells(once, 2, lone_hits(once, NO_HITS)).all()
    assert not lone_hits(twice, NO_HITS).any()


def test_two_hits_side_by_side_are_not_lone_and_one_of_them_may_be_on_ground_seen_free() -> None:
    grid = grid_of(".....", ".!...", "..!..", ".....", ".....")
    assert not lone_hits(grid, NO_HITS).any()
    hit = NO_HITS.copy()
    hit[0, 3] = True
    assert np.argwhere(lone_hits(grid, hit)).tolist() == [[0, 3]]
    hit[1, 2] = True
    assert not lone_hits(grid, hit).any()


@given(hnp.arrays(np.uint8, (7, 8), elements=st.sampled_from([0, 3, 127, 128, 129, 200, 217, 218, 255])))
def test_a_lone_hit_has_no_occupied_neighbour_and_little_evidence(cells: NDArray[np.uint8]) -> None:
    found = lone_hits(OccupancyGrid(GridSpec(1.0, 0.0, 0.0, (7, 8)), cells), np.zeros((7, 8), np.bool_))
    for row, col in np.ndindex(7, 8):
        around = cells[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2]
        assert found[row, col] == (128 < cells[row, col] <= 217 and (around > 128).sum() == 1)
