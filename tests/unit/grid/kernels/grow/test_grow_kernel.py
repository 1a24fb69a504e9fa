"""Growing by a disk in C and in NumPy against the Minkowski sum, in any window."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.kernels import Kernels
from robotd.grid.window import CellWindow
from tests.support.kernel_tables import NATIVE, both, needs_native


@both
@settings(max_examples=150, deadline=None)
@given(
    st.integers(0, 2**32),
    st.tuples(st.integers(1, 40), st.integers(1, 70)),
    st.sampled_from([0.0, 0.9, 1.0, 1.5, 2.0, 5.5, 30.0]),
    st.booleans(),
)
def test_the_window_is_grown_as_the_whole_is_and_nothing_else_is_touched(
    kernels: Kernels, seed: int, shape: tuple[int, int], radius: float, outside: bool
) -> None:
    random = np.random.default_rng(seed)
    mask = random.random(shape) < random.choice([0.01, 0.1, 0.6])
    corners = random.integers(0, mask.size, 2)
    window = CellWindow.bounding(np.sort(corners), shape)
    before = random.random(shape) < 0.5
    grown = before.copy()
    kernels.grow.grow_disk(mask, grown, window, radius_cells=radius, outside=outside)
    expected = before.copy()
    expected[window.slices] = dilate(mask, disk_footprint(radius), outside=outside)[window.slices]
    assert np.array_equal(grown, expected)


@both
def test_cells_that_lie_apart_in_memory_are_read_as_they_are(kernels: Kernels) -> None:
    mask = np.zeros((6, 8), np.bool_)
    mask[2, 3] = True
    grown = np.empty((3, 4), np.bool_)
    kernels.grow.grow_disk(mask[::2, 1::2], grown, CellWindow.whole((3, 4)), radius_cells=1.0, outside=False)
    assert grown.astype(int).tolist() == [[0, 1, 0, 0], [1, 1, 1, 0], [0, 1, 0, 0]]


@both
def test_a_negative_radius_is_refused(kernels: Kernels) -> None:
    cells = np.zeros((3, 3), np.bool_)
    with pytest.raises(ValueError, match="radius_cells must not be negative"):
        kernels.grow.grow_disk(cells, cells.copy(), CellWindow.whole((3, 3)), radius_cells=-1.0, outside=False)


@needs_native
def test_a_radius_that_a_byte_cannot_hold_is_refused() -> None:
    cells = np.zeros((3, 3), np.bool_)
    with pytest.raises(ValueError, match="radius_cells must be less than 255"):
        NATIVE.grow.grow_disk(cells, cells.copy(), CellWindow.whole((3, 3)), radius_cells=255.0, outside=False)
