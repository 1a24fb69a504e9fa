"""Sweeps inserted in C change the cells that NumPy changes, to the same values, under both policies."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, Pose2
from robotd.grid.kernels.twins import TWINS
from robotd.grid.tables import lower_table, raise_table
from tests.support.kernel_tables import NATIVE, needs_native

pytestmark = needs_native

SHAPE = (23, 31)
TABLES = (lower_table(0.15), raise_table(0.3))
SPEC = GridSpec(0.5, -1.25, 2.0, SHAPE)
places_m = st.one_of(st.floats(-30.0, 30.0), st.sampled_from([-1.25, 2.0, 0.0, 0.25, 4.5]))
bearings = st.one_of(st.floats(-7.0, 7.0), st.integers(-8, 8).map(lambda k: k * np.pi / 4))
ranges_m = st.one_of(st.floats(1e-3, 45.0), st.sampled_from([0.5, 2.0, 1e12, 1e300, 1.7e308]))
starts_m = st.sampled_from([0.0, 0.0, 0.3, -2.0])
readings = st.lists(st.tuples(bearings, ranges_m, starts_m, starts_m, st.sampled_from([0.0, 0.0, 1.0])), max_size=12)


@settings(max_examples=300, deadline=None)
@given(readings, st.builds(Pose2, places_m, places_m, bearings), st.integers(0, 2**32), st.booleans())
def test_the_same_cells_change_to_the_same_values(
    drawn: list[tuple[float, float, float, float, float]], pose: Pose2, seed: int, at_once: bool
) -> None:
    numbers = np.array(drawn, np.float64).reshape(-1, 5)
    one = np.random.default_rng(seed).integers(0, 256, SHAPE, np.uint8)
    other = one.copy()
    with np.errstate(over="ignore"):  # a beam may be longer than any number of cells
        expected = TWINS.insert.insert_sweep(other, numbers, pose, SPEC, TABLES, at_once=at_once)
    changed = NATIVE.insert.insert_sweep(one, numbers, pose, SPEC, TABLES, at_once=at_once)
    assert changed.tolist() == expected.tolist()
    assert np.array_equal(one, other)


def test_a_grid_that_nobody_may_change_is_refused() -> None:
    cells = np.zeros(SHAPE, np.uint8)
    cells.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        NATIVE.insert.insert_sweep(cells, np.zeros((1, 5)), IDENTITY, SPEC, TABLES, at_once=True)
