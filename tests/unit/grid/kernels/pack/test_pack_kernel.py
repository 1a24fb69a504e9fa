"""Packing a window anew leaves what packing all of it would."""

import importlib
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.kernels import twins
from robotd.grid.kernels.shared.packed_map import pack
from robotd.grid.window import CellWindow

try:
    NATIVE: ModuleType = importlib.import_module("robotd.grid.kernels.native")
except ImportError:
    NATIVE = twins
both = pytest.mark.parametrize("kernels", {"numpy": twins, "c": NATIVE}.values(), ids=["numpy", "c or numpy"])


@both
@settings(max_examples=150, deadline=None)
@given(
    st.integers(0, 2**32),
    st.tuples(st.integers(1, 40), st.integers(1, 300)),
    st.tuples(st.integers(0, 31), st.integers(0, 63)),
    st.booleans(),
)
def test_a_window_packed_anew_is_as_if_all_was(
    kernels: ModuleType, seed: int, shape: tuple[int, int], origin: tuple[int, int], outside: bool
) -> None:
    random = np.random.default_rng(seed)
    before = random.random(shape) < 0.5
    window = CellWindow.bounding(np.sort(random.integers(0, before.size, random.integers(0, 3))), shape)
    after = before.copy()
    after[window.slices] = random.random(window.shape) < 0.5
    words = pack(before, origin, outside=outside)
    kernels.pack_cells(words, after, origin, window)
    assert np.array_equal(words, pack(after, origin, outside=outside))
