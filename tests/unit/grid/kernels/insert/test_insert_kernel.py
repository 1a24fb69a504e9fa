"""Sweeps inserted in C change the cells that NumPy changes, to the same values, under both policies."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, Pose2
from robotd.grid.kernels import Kernels
from robotd.grid.kernels.twins import TWINS
from robotd.grid.tables import NO_INFORMATION, lower_table, raise_table
from tests.support.kernel_tables import NATIVE, both, needs_native

SHAPE = (23, 31)
TABLES = (lower_table(0.15), raise_table(0.3))
SPEC = GridSpec(0.5, -1.25, 2.0, SHAPE)
places_m = st.one_of(st.floats(-30.0, 30.0), st.sampled_from([-1.25, 2.0, 0.0, 0.25, 4.5]))
bearings = st.one_of(st.floats(-7.0, 7.0), st.integers(-8, 8).map(lambda k: k * np.pi / 4))
ranges_m = st.one_of(st.floats(1e-3, 45.0), st.sampled_from([0.5, 2.0, 1e12, 1e300, 1.7e308]))
starts_m = st.sampled_from([0.0, 0.0, 0.3, -2.0])
readings = st.lists(st.tuples(bearings, ranges_m, starts_m, starts_m, st.sampled_from([0.0, 0.0, 1.0])), max_size=12)

Row = tuple[float, float, float, float, float]


def rows_of(drawn: list[Row]) -> NDArray[np.float64]:
    return np.array(drawn, np.float64).reshape(-1, 5)


@needs_native
@settings(max_examples=300, deadline=None)
@given(
    readings, st.none() | readings, st.builds(Pose2, places_m, places_m, bearings), st.integers(0, 2**32), st.booleans()
)
def test_the_same_cells_change_to_the_same_values(
    drawn: list[Row], between: list[Row] | None, pose: Pose2, seed: int, at_once: bool
) -> None:
    numbers, filled = rows_of(drawn), None if between is None else rows_of(between)
    one = np.random.default_rng(seed).integers(0, 256, SHAPE, np.uint8)
    one[:, 10:20] = NO_INFORMATION
    other = one.copy()
    with np.errstate(over="ignore"):  # a beam may be longer than any number of cells
        expected = TWINS.insert.insert_sweep(other, numbers, pose, SPEC, TABLES, at_once=at_once, between=filled)
    changed = NATIVE.insert.insert_sweep(one, numbers, pose, SPEC, TABLES, at_once=at_once, between=filled)
    assert changed.tolist() == expected.tolist()
    assert np.array_equal(one, other)


@both
def test_what_lies_between_changes_unseen_cells_alone(kernels: Kernels) -> None:
    cells = np.array([[NO_INFORMATION, 255, 0, NO_INFORMATION, NO_INFORMATION, NO_INFORMATION]], np.uint8)
    spec, none, filled = GridSpec(1.0, 0.0, 0.0, (1, 6)), np.empty((0, 5)), np.array([[0.0, 4.5, 0.0, 0.0, 1.0]])
    changed = kernels.insert.insert_sweep(cells, none, Pose2(0.0, 0.5, 0.0), spec, TABLES, at_once=True, between=filled)
    lowered = int(TABLES[0][NO_INFORMATION])
    assert cells.tolist() == [[lowered, 255, 0, lowered, lowered, NO_INFORMATION]]
    assert changed.tolist() == [0, 3, 4]


@needs_native
def test_a_grid_that_nobody_may_change_is_refused() -> None:
    cells = np.zeros(SHAPE, np.uint8)
    cells.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        NATIVE.insert.insert_sweep(cells, np.zeros((1, 5)), IDENTITY, SPEC, TABLES, at_once=True)
