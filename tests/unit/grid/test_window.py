"""Windows hold what they must and nothing outside the grid."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robotd.grid.window import CellWindow

shapes = st.tuples(st.integers(1, 9), st.integers(1, 9))


@given(shapes, st.data())
def test_a_bounding_window_is_the_smallest_that_holds_the_cells(shape: tuple[int, int], data: st.DataObject) -> None:
    flat = sorted(data.draw(st.sets(st.integers(0, shape[0] * shape[1] - 1), min_size=1)))
    window = CellWindow.bounding(np.array(flat, np.intp), shape)
    rows, cols = np.divmod(flat, shape[1])
    assert (window.first_row, window.end_row) == (rows.min(), rows.max() + 1)
    assert (window.first_col, window.end_col) == (cols.min(), cols.max() + 1)


@given(shapes, st.integers(0, 12), st.data())
def test_a_grown_window_holds_what_is_near_and_on_the_grid(
    shape: tuple[int, int], by: int, data: st.DataObject
) -> None:
    flat = np.array([data.draw(st.integers(0, shape[0] * shape[1] - 1))], np.intp)
    window = CellWindow.bounding(flat, shape)
    near = np.zeros(shape, np.bool_)
    near[window.grown(by, shape).slices] = True
    row, col = divmod(int(flat[0]), shape[1])
    expected = [[abs(i - row) <= by and abs(j - col) <= by for j in range(shape[1])] for i in range(shape[0])]
    assert near.tolist() == expected


def test_no_cells_are_an_empty_window_and_stay_one() -> None:
    window = CellWindow.bounding(np.empty(0, np.intp), (4, 5))
    assert window.is_empty
    assert window.grown(3, (4, 5)).is_empty
    assert CellWindow.whole((4, 5)).shape == (4, 5)
