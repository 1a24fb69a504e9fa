import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.grid.wall_field import WallField
from robotd.grid.window import CellWindow

SHAPE = (90, 110)
SPEC = GridSpec(0.05, 0.0, 0.0, SHAPE)


@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 2**32),
    st.sampled_from([0.0, 0.002, 0.02]),
    st.tuples(st.integers(0, 89), st.integers(1, 40)),
    st.tuples(st.integers(0, 109), st.integers(1, 40)),
)
def test_a_field_that_was_updated_is_as_if_made_whole(
    seed: int, share: float, rows: tuple[int, int], cols: tuple[int, int]
) -> None:
    random = np.random.default_rng(seed)
    walls, blocking = random.random(SHAPE) < share, random.random(SHAPE) < share
    field = WallField.of(SPEC, walls, blocking)
    before = field.codes.copy(), field.skips.copy()
    window = CellWindow(rows[0], min(90, sum(rows)), cols[0], min(110, sum(cols)))
    walls[window.slices] = random.random(window.shape) < 3 * share
    blocking[window.slices] = random.random(window.shape) < 3 * share
    updated, whole = field.updated(walls, blocking, window), WallField.of(SPEC, walls, blocking)
    np.testing.assert_array_equal(updated.codes, whole.codes)
    np.testing.assert_array_equal(updated.skips, whole.skips)
    np.testing.assert_array_equal(field.codes, before[0])
    np.testing.assert_array_equal(field.skips, before[1])


def test_a_field_stays_as_it_is_if_nothing_changed() -> None:
    walls = np.zeros(SHAPE, np.bool_)
    field = WallField.of(SPEC, walls, walls)
    assert field.updated(walls, walls, CellWindow(0, 0, 0, 0)) is field
