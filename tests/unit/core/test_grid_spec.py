"""Placement: one cell at a time and many at once agree."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec

SPEC = GridSpec(0.05, -6.4, -3.2, (128, 256))
points = st.lists(st.tuples(st.floats(-10, 10), st.floats(-10, 10)), min_size=1, max_size=5)


@given(points)
def test_many_cells_at_once_are_the_cells_one_by_one(points_m: list[tuple[float, float]]) -> None:
    cells = [SPEC.cell_at(*point) for point in points_m]
    flat = [row * SPEC.cols + col if SPEC.contains(row, col) else -1 for row, col in cells]
    assert SPEC.flat_at(np.array(points_m)).tolist() == flat


@given(st.integers(0, 127), st.integers(0, 255))
def test_the_centre_of_a_cell_lies_in_it(row: int, col: int) -> None:
    assert SPEC.cell_at(*SPEC.centre_of(row, col)) == (row, col)
