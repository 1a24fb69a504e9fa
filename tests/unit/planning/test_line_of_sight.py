"""Pulling a way straight keeps it on free ground and makes it no longer."""

import itertools
import math

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.planning.line_of_sight import (
    Position,
    centre_of,
    distances_of_leg,
    in_sight,
    pulled_straight,
    touched_cells,
)

maps = hnp.arrays(np.bool_, (9, 11), elements=st.sampled_from([True] * 5 + [False]))
cells = st.tuples(st.integers(0, 8), st.integers(0, 10))


positions = st.tuples(st.floats(0.0, 8.99), st.floats(0.0, 10.99))
on_quarters = st.tuples(st.integers(0, 35), st.integers(0, 43)).map(lambda at: (at[0] / 4, at[1] / 4))


def slow_distance(cell: tuple[int, int], one: Position, other: Position) -> float:
    """Return how near a leg comes to a cell, from very many points of it."""
    shares = np.linspace(0.0, 1.0, 4001)[:, None]
    points = np.array(one) + shares * (np.array(other) - np.array(one))
    outside = np.maximum(np.maximum(np.array(cell) - points, points - np.array(cell) - 1.0), 0.0)
    return float(np.hypot(*outside.T).min())


@settings(max_examples=150)
@given(maps, st.one_of(positions, on_quarters), st.one_of(positions, on_quarters))
def test_in_sight_means_that_no_cell_that_the_leg_runs_through_is_taken(
    free: NDArray[np.bool_], one: Position, other: Position
) -> None:
    shares = np.linspace(0.0, 1.0, 2001)[:, None]
    points = np.array(one) + shares * (np.array(other) - np.array(one))
    inside = points[(np.abs(points - np.round(points)) > 1e-6).all(axis=1)]  # what lies on an edge is in two cells
    cells = np.floor(inside).astype(np.intp)
    if not free[tuple(cells.T)].all():
        assert not in_sight(free, one, other)
    met = touched_cells(one, other)
    assert all(slow_distance(tuple(cell), one, other) < 1e-2 for cell in met.tolist())
    assert in_sight(free, one, other) == bool(free[tuple(met.T)].all())


@settings(max_examples=100)
@given(cells, st.one_of(positions, on_quarters), st.one_of(positions, on_quarters))
@example((0, 0), (1.0, 0.0), (1.0, 5e-324))
def test_how_near_a_leg_comes_to_a_cell(cell: tuple[int, int], one: Position, other: Position) -> None:
    found = float(distances_of_leg(np.array([cell]), one, other)[0])
    assert found <= slow_distance(cell, one, other) + 1e-9
    assert found >= slow_distance(cell, one, other) - 0.01


def test_off_the_map_nothing_is_in_sight() -> None:
    assert not in_sight(np.ones((3, 3), np.bool_), (1.5, 1.5), (1.5, 3.5))
    assert not in_sight(np.ones((3, 3), np.bool_), (1.5, 1.5), (-0.5, 1.5))


@st.composite
def ways(draw: st.DrawFn) -> list[tuple[int, int]]:
    """A walk from neighbour to neighbour."""
    way = [draw(cells)]
    for row, col in draw(st.lists(st.tuples(st.integers(-1, 1), st.integers(-1, 1)), max_size=25)):
        onward = (way[-1][0] + row, way[-1][1] + col)
        if (row, col) != (0, 0) and 0 <= onward[0] < 9 and 0 <= onward[1] < 11:
            way.append(onward)
    return way


@settings(max_examples=150)
@given(maps, ways())
def test_a_pulled_way_keeps_its_ends_and_stays_in_sight(free: NDArray[np.bool_], way: list[tuple[int, int]]) -> None:
    free = free.copy()
    free[tuple(np.array(way).T)] = True
    points = [centre_of(cell) for cell in way]
    corners = pulled_straight(free, points)
    assert (corners[0], corners[-1]) == (0, len(way) - 1)
    assert corners == sorted(corners)
    for one, other in itertools.pairwise(corners):
        assert other == one + 1 or in_sight(free, points[one], points[other])
    length = sum(math.dist(points[one], points[other]) for one, other in itertools.pairwise(corners))
    assert length <= sum(math.dist(one, other) for one, other in itertools.pairwise(points)) + 1e-9


def test_an_open_floor_is_crossed_in_one_leg() -> None:
    way = [(0, 0), (0, 1), (1, 2), (2, 3), (2, 4)]
    assert pulled_straight(np.ones((9, 11), np.bool_), [centre_of(cell) for cell in way]) == [0, 4]


def test_a_leg_does_not_cut_the_corner_of_a_cell() -> None:
    """Sampled once a column, this leg runs through free cells alone; it cuts the corner of the one that is not."""
    free = np.ones((2, 3), np.bool_)
    free[1, 1] = False
    assert [1, 1] in touched_cells((0.5, 0.5), (1.5, 2.5)).tolist()
    assert not in_sight(free, (0.5, 0.5), (1.5, 2.5))
