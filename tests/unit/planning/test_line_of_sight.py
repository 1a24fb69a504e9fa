"""Pulling a way straight keeps it on free ground and makes it no longer."""

import itertools
import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.planning.line_of_sight import in_sight, pulled_straight

maps = hnp.arrays(np.bool_, (9, 11), elements=st.sampled_from([True] * 5 + [False]))
cells = st.tuples(st.integers(0, 8), st.integers(0, 10))


def crossed(one: tuple[int, int], other: tuple[int, int]) -> list[tuple[int, int]]:
    """One cell per step along the dominant axis, by whole numbers; ties, which may go either way, are left out."""
    rows, cols = other[0] - one[0], other[1] - one[1]
    steps = max(abs(rows), abs(cols))
    return [
        (one[0] + math.floor(k * rows / steps + 0.5), one[1] + math.floor(k * cols / steps + 0.5))
        for k in range(steps + 1)
        if steps and not any(abs(2 * k * part) % (2 * steps) == steps for part in (rows, cols))
    ]


@settings(max_examples=150)
@given(maps, cells, cells)
def test_in_sight_means_all_cells_between_are_free(
    free: NDArray[np.bool_], one: tuple[int, int], other: tuple[int, int]
) -> None:
    between = crossed(one, other) or [one]
    if not all(free[cell] for cell in between):
        assert not in_sight(free, one, other)
    elif len(between) == max(abs(one[0] - other[0]), abs(one[1] - other[1])) + 1:
        assert in_sight(free, one, other)


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
    corners = pulled_straight(free, way)
    assert (corners[0], corners[-1]) == (way[0], way[-1])
    assert all(corner in way for corner in corners)
    assert all(in_sight(free, one, other) for one, other in itertools.pairwise(corners))
    length = sum(math.dist(one, other) for one, other in itertools.pairwise(corners))
    assert length <= sum(math.dist(one, other) for one, other in itertools.pairwise(way)) + 1e-9


def test_an_open_floor_is_crossed_in_one_leg() -> None:
    assert pulled_straight(np.ones((9, 11), np.bool_), [(0, 0), (0, 1), (1, 2), (2, 3), (2, 4)]) == [(0, 0), (2, 4)]
