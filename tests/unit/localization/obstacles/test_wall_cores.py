"""Thick walls are made thin, thin ones are left alone, and what was updated is as if made from nothing."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.grid.growth import grown_by_disk
from robotd.grid.window import CellWindow
from robotd.localization.obstacles.thick_walls import ThickWalls
from robotd.localization.obstacles.wall_cores import WallCores

CELL_M = 0.05
VACANT, UNKNOWN, WALL = np.uint8(0), np.uint8(128), np.uint8(255)


def room(pen_cells: int) -> NDArray[np.uint8]:
    """Return a room with walls of one cell, drawn with a pen that adds cells on either side."""
    walls = np.zeros((60, 80), np.bool_)
    walls[[12, 47], 12:68] = walls[12:48, [12, 67]] = walls[12:35, 40] = True
    inside = np.zeros_like(walls)
    inside[13:47, 13:67] = True
    drawn = grown_by_disk(walls, float(pen_cells))
    return np.where(drawn, WALL, np.where(inside, VACANT, UNKNOWN)).astype(np.uint8)


def cores_of(cells: NDArray[np.uint8], resolution_m: float = CELL_M) -> WallCores:
    return WallCores.of(cells > 128, resolution_m)


def test_walls_as_thin_as_usual_are_left_as_they_are() -> None:
    cells = room(0)
    cores = cores_of(cells)
    assert (cores.depth_cells, cores.reach_cells) == (0, 0)
    assert cores.before_cores() is None
    assert cores.readings_of(cells) == (cells,)


@pytest.mark.parametrize("pen_cells", [2, 3, 4])
def test_of_a_broad_pen_the_line_in_its_middle_is_left(pen_cells: int) -> None:
    cells, thin = room(pen_cells), room(0)
    cores = cores_of(cells)
    drawn, thinned = cores.readings_of(cells)
    assert drawn is cells
    assert cores.depth_cells in (pen_cells - 1, pen_cells)
    off = grown_by_disk(thin == WALL, float(pen_cells - cores.depth_cells))
    # The corners of a line are its own, and what a pen fills between two lines is a wall to anyone.
    assert ((thinned == WALL) != off).sum() <= 10 * pen_cells
    # A beam from inside runs up to the core, and none comes through it.
    assert (thinned[14:46, 14:66][thin[14:46, 14:66] == VACANT] != UNKNOWN).all()


def test_read_as_drawn_walls_are_as_thick_as_they_are() -> None:
    cells = room(3)
    cores = WallCores.of(cells > 128, CELL_M, ThickWalls.AS_DRAWN)
    assert cores.readings_of(cells) == (cells,)
    assert cores.updated(cells > 128, CellWindow(0, 9, 0, 9)).depth_cells == 0


def test_no_wall_is_taken_off_whole() -> None:
    cells = room(3)
    cells[30, 20:30] = WALL  # a thin one among thick ones
    assert (cores_of(cells).readings_of(cells)[1][30, 20:30] == WALL).all()


def test_solid_things_say_nothing_of_the_pen() -> None:
    cells = room(0)
    cells[20:40, 45:60] = WALL
    assert cores_of(cells).depth_cells == 0


@pytest.mark.parametrize(
    ("resolution_m", "cells_thick", "depth"), [(0.1, 2, 0), (0.1, 3, 1), (0.2, 2, 0), (0.02, 5, 0), (0.02, 9, 2)]
)
def test_thick_is_meant_in_metres(resolution_m: float, cells_thick: int, depth: int) -> None:
    cells = np.zeros((60, 80), np.uint8)
    cells[20 : 20 + cells_thick] = WALL
    assert cores_of(cells, resolution_m).depth_cells == depth


def test_a_map_without_walls_is_left_as_it_is() -> None:
    cells = np.full((4, 5), UNKNOWN)
    assert cores_of(cells).readings_of(cells) == (cells,)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 4))
def test_updated_is_as_if_made_from_nothing(seed: int, pen_cells: int) -> None:
    random = np.random.default_rng(seed)
    cells = room(pen_cells)
    before = cores_of(cells)
    row, col = int(random.integers(50)), int(random.integers(70))
    changed = CellWindow(row, row + 9, col, col + 8)
    cells[changed.slices] = random.choice(np.array([VACANT, UNKNOWN, WALL]), changed.shape)
    updated, fresh = before.updated(cells > 128, changed), cores_of(cells)
    np.testing.assert_array_equal(updated.thicknesses, fresh.thicknesses)
    assert all(map(np.array_equal, updated.readings_of(cells), fresh.readings_of(cells)))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32))
def test_cells_change_no_farther_than_said(seed: int) -> None:
    random = np.random.default_rng(seed)
    cells = room(3)
    cores, before = cores_of(cells), cores_of(cells).readings_of(cells)[1]
    changed = CellWindow(25, 30, 30, 37)
    cells[changed.slices] = random.choice(np.array([VACANT, UNKNOWN, WALL]), changed.shape)
    after = cores.updated(cells > 128, changed).readings_of(cells)[1]
    near = np.zeros(cells.shape, np.bool_)
    near[changed.grown(cores.reach_cells, cells.shape).slices] = True
    assert not (before != after)[~near].any()
