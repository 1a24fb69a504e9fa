"""The distance field against Dijkstra's algorithm with a heap."""

import heapq
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.planning.distance_field import distance_field

maps = hnp.arrays(
    np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.sampled_from([True, True, True, False])
)


def slow_field(free: NDArray[np.bool_], goal: tuple[int, int]) -> NDArray[np.float64]:
    field = np.full(free.shape, np.inf)
    queue = [(0.0, goal)] if free[goal] else []
    while queue:
        distance, (row, col) = heapq.heappop(queue)
        if distance >= field[row, col]:
            continue
        field[row, col] = distance
        for i, j in np.ndindex(3, 3):
            near = (row + i - 1, col + j - 1)
            inside = 0 <= near[0] < free.shape[0] and 0 <= near[1] < free.shape[1]
            if inside and free[near]:
                heapq.heappush(queue, (distance + math.hypot(i - 1, j - 1), near))
    return field


@settings(max_examples=150)
@given(maps, st.data())
def test_the_field_is_the_shortest_way(free: NDArray[np.bool_], data: st.DataObject) -> None:
    goal = (data.draw(st.integers(0, free.shape[0] - 1)), data.draw(st.integers(0, free.shape[1] - 1)))
    field, expected = distance_field(free, goal), slow_field(free, goal)
    assert np.array_equal(np.isinf(field), np.isinf(expected))
    assert np.allclose(field, expected)


@pytest.mark.parametrize("seed", range(4))
def test_ways_that_meet_from_different_wavefronts_are_compared(seed: int) -> None:
    free = np.random.default_rng(seed).random((45, 50)) < 0.75
    free[20, 20] = True
    assert np.allclose(distance_field(free, (20, 20)), slow_field(free, (20, 20)))


def test_a_long_corridor_is_followed_to_its_end() -> None:
    """A maze whose way is many times longer than the grid is wide."""
    free = np.ones((41, 30), np.bool_)
    for number, row in enumerate(range(1, 41, 2)):
        free[row] = False
        free[row, 0 if number % 2 else -1] = True
    field = distance_field(free, (0, 0))
    assert np.allclose(field, slow_field(free, (0, 0)))
    assert field[40, 29 if np.isfinite(field[40, 29]) else 0] > 500


def test_from_a_closed_room_nothing_is_reached() -> None:
    free = np.ones((5, 7), np.bool_)
    free[:, 3] = False
    field = distance_field(free, (2, 1))
    assert np.isfinite(field[:, :3]).all()
    assert np.isinf(field[:, 3:]).all()
