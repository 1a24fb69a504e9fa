"""Translation, cell by cell."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robotd.grid.translation import translated

sizes = st.integers(1, 6)
steps = st.integers(-9, 9)


@given(sizes, sizes, steps, steps, st.none() | st.tuples(sizes, sizes))
def test_each_cell_shows_what_lies_that_far_from_it(
    rows: int, cols: int, row: int, col: int, shape: tuple[int, int] | None
) -> None:
    cells = np.arange(1, rows * cols + 1, dtype=np.int32).reshape(rows, cols)
    moved = translated(cells, row, col, outside=-1, shape=shape)
    assert moved.dtype == cells.dtype
    assert moved.shape == (shape or cells.shape)
    for r, c in np.ndindex(moved.shape):
        inside = 0 <= r + row < rows and 0 <= c + col < cols
        assert moved[r, c] == (cells[r + row, c + col] if inside else -1)
