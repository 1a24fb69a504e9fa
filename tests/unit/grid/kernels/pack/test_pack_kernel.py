"""Packing a window again leaves what packing all of it would."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.kernels import Kernels
from robotd.grid.kernels.shared.packed_map import pack
from robotd.grid.window import CellWindow
from tests.support.kernel_tables import both


@both
@settings(max_examples=150, deadline=None)
@given(
    st.integers(0, 2**32),
    st.tuples(st.integers(1, 40), st.integers(1, 300)),
    st.tuples(st.integers(0, 31), st.integers(0, 63)),
    st.booleans(),
)
def test_a_window_packed_anew_is_as_if_all_was(
    kernels: Kernels, seed: int, shape: tuple[int, int], origin: tuple[int, int], outside: bool
) -> None:
    random = np.random.default_rng(seed)
    before = random.random(shape) < 0.5
    window = CellWindow.bounding(np.sort(random.integers(0, before.size, random.integers(0, 3))), shape)
    after = before.copy()
    after[window.slices] = random.random(window.shape) < 0.5
    words = pack(before, origin, outside=outside)
    kernels.pack.pack_cells(words, after, origin, window)
    assert np.array_equal(words, pack(after, origin, outside=outside))
