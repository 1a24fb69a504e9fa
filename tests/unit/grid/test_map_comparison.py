"""Two maps compared, against a slow obvious twin and on maps whose difference is known."""

import math
from itertools import product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.grid.map_comparison import compare_maps
from robotd.grid.occupancy import OccupancyGrid

specs = st.builds(
    lambda resolution, row, col, shape: GridSpec(resolution, col * 0.25, row * 0.25, shape),
    st.sampled_from([0.25, 0.5]),
    st.integers(-3, 3),
    st.integers(-3, 3),
    st.tuples(st.integers(1, 6), st.integers(1, 6)),
)
grids = st.builds(
    lambda spec, seed: OccupancyGrid(
        spec, np.random.default_rng(seed).choice(np.array([0, 128, 255], np.uint8), spec.shape)
    ),
    specs,
    st.integers(0, 2**32 - 1),
)


def kind(grid: OccupancyGrid, x_m: float, y_m: float) -> int:
    row, col = grid.spec.cell_at(x_m, y_m)
    return int(grid.cells[row, col]) // 127 if grid.spec.contains(row, col) else 1


@given(grids, grids)
def test_cells_are_counted_as_a_slow_twin_counts_them(first: OccupancyGrid, second: OccupancyGrid) -> None:
    found = compare_maps(first, second)
    counts = np.zeros((3, 3), int)
    walls: tuple[list[tuple[float, float]], list[tuple[float, float]]] = ([], [])
    for row, col in product(*map(range, first.spec.shape)):
        at = first.spec.centre_of(row, col)
        kinds = kind(first, *at), kind(second, *at)
        counts[kinds] += 1
        for number in range(2):
            if kinds[number] == 2:
                walls[number].append(at)
    np.testing.assert_array_equal(found.counts, counts)
    for own, other, off_m in (*[(*walls, found.first_walls_off_m)], (*walls[::-1], found.second_walls_off_m)):
        slow = sorted(min((math.dist(a, b) for b in other), default=math.inf) for a in own)
        np.testing.assert_allclose(off_m, slow, atol=1e-9)


@given(grids)
def test_a_map_agrees_with_itself(grid: OccupancyGrid) -> None:
    found = compare_maps(grid, grid)
    assert found.agreement in {1.0, None}
    assert not found.first_walls_off_m.any()


def test_a_wall_that_was_moved_is_as_far_off_as_it_was_moved() -> None:
    cells = np.zeros((20, 20), np.uint8)
    cells[:, 5] = 255
    spec = GridSpec(0.05, 0.0, 0.0, (20, 20))
    found = compare_maps(OccupancyGrid(spec, cells), OccupancyGrid(spec, np.roll(cells, 3, axis=1)))
    np.testing.assert_allclose(found.first_walls_off_m, 0.15)
    assert found.agreement == 1 - 40 / 400
