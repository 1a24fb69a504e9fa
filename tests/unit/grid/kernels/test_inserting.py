"""Sweeps inserted in C change the cells that NumPy changes, to the same values, under both policies."""

import importlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.kernels import twins
from robotd.grid.kernels.layout import Rays
from robotd.grid.tables import lower_table, raise_table

try:
    native = importlib.import_module("robotd.grid.kernels.native")
except ImportError:
    pytest.skip("robotd was installed without a compiler", allow_module_level=True)

SHAPE = (23, 31)
LOWER, RAISE = lower_table(0.15), raise_table(0.3)
places = st.one_of(st.floats(-60.0, 60.0), st.sampled_from([0.0, 0.5, 11.5, 23.0, 31.0]))
bearings = st.one_of(st.floats(-7.0, 7.0), st.integers(-8, 8).map(lambda k: k * np.pi / 4))
lengths = st.one_of(st.floats(0.0, 90.0), st.sampled_from([0.0, 1.0, 1e12, 1e300]))
hits = st.integers(-1, SHAPE[0] * SHAPE[1] - 1)
beams = st.lists(st.tuples(places, places, bearings, lengths, hits), max_size=12)


@settings(max_examples=200, deadline=None)
@given(beams, st.integers(0, 2**32), st.booleans())
def test_the_same_cells_change_to_the_same_values(
    drawn: list[tuple[float, float, float, float, int]], seed: int, at_once: bool
) -> None:
    numbers = np.array([beam[:4] for beam in drawn], np.float64).reshape(-1, 4)
    rays = Rays(
        np.ascontiguousarray(numbers[:, :2]),
        np.ascontiguousarray(numbers[:, 2]),
        np.ascontiguousarray(numbers[:, 3]),
        np.array([beam[4] for beam in drawn], np.intp),
    )
    one = np.random.default_rng(seed).integers(0, 256, SHAPE, np.uint8)
    other = one.copy()
    changed = native.insert_rays(one, rays, LOWER, RAISE, at_once=at_once)
    assert changed.tolist() == twins.insert_rays(other, rays, LOWER, RAISE, at_once=at_once).tolist()
    assert np.array_equal(one, other)


def test_a_grid_that_nobody_may_change_is_refused() -> None:
    cells = np.zeros(SHAPE, np.uint8)
    cells.flags.writeable = False
    rays = Rays(np.zeros((1, 2)), np.zeros(1), np.ones(1), np.array([3]))
    with pytest.raises(ValueError, match="read-only"):
        native.insert_rays(cells, rays, LOWER, RAISE, at_once=True)
