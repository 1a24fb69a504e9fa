"""The distance transform in C against its twin, in any window and up to any limit."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.grid.kernels import Kernels
from robotd.grid.kernels.distance.distance_kernel import NOWHERE
from robotd.grid.window import CellWindow
from tests.support.kernel_tables import both


def drawn_sources(seed: int, rows: int, cols: int, share: float) -> NDArray[np.bool_]:
    return np.random.default_rng(seed).random((rows, cols)) < share


sources_of_any_kind = st.builds(
    drawn_sources,
    st.integers(0, 2**32),
    st.integers(1, 30),
    st.integers(1, 30),
    st.sampled_from([0.0, 0.005, 0.03, 0.3, 1.0]),
)


def windows_of(shape: tuple[int, ...]) -> st.SearchStrategy[CellWindow]:
    rows, cols = (
        st.tuples(st.integers(0, size - 1), st.integers(1, size)).map(lambda ends: (min(ends), max(ends) + 1))
        for size in shape
    )
    return st.builds(
        lambda row, col: CellWindow(row[0], min(row[1], shape[0]), col[0], min(col[1], shape[1])), rows, cols
    )


def slow_squares(sources: NDArray[np.bool_], limit: int, *, outside: bool) -> NDArray[np.int64]:
    points = np.argwhere(np.pad(sources, 1, constant_values=outside)) - 1
    cells = np.argwhere(np.ones_like(sources))
    squares = ((cells[:, None] - points) ** 2).sum(axis=2).min(axis=1, initial=NOWHERE).reshape(sources.shape)
    return np.where(squares <= limit**2, squares, NOWHERE)


@both
@settings(max_examples=150, deadline=None)
@given(sources_of_any_kind, st.sampled_from([0, 1, 2, 5, 20, 1 << 14]), st.booleans(), st.data())
def test_squares_are_right_in_the_window_and_left_alone_elsewhere(
    kernels: Kernels, sources: NDArray[np.bool_], limit: int, outside: bool, data: st.DataObject
) -> None:
    window = data.draw(windows_of(sources.shape))
    squares = np.full(sources.shape, -1, np.int32)
    kernels.distance.squared_distances(sources, squares, window, limit_cells=limit, outside=outside)
    expected = np.full(sources.shape, -1)
    expected[window.slices] = slow_squares(sources, limit, outside=outside)[window.slices]
    assert np.array_equal(squares, expected)


@both
def test_an_empty_window_changes_nothing(kernels: Kernels) -> None:
    squares = np.full((3, 3), -1, np.int32)
    kernels.distance.squared_distances(
        np.ones((3, 3), np.bool_), squares, CellWindow(1, 1, 0, 3), limit_cells=2, outside=False
    )
    assert (squares == -1).all()


@both
def test_the_longest_grid_overflows_nowhere(kernels: Kernels) -> None:
    sources = np.zeros((1, 8192), np.bool_)
    sources[0, 0] = True
    squares = np.empty(sources.shape, np.int32)
    window = CellWindow(0, 1, 8180, 8192)
    kernels.distance.squared_distances(sources, squares, window, limit_cells=1 << 14, outside=False)
    assert squares[0, 8180:].tolist() == [col**2 for col in range(8180, 8192)]
