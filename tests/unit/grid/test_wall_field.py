import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.spec import GridSpec
from robotd.grid.wall_field import WallField

SHAPE = (90, 110)
SPEC = GridSpec(0.05, 0.0, 0.0, SHAPE)


@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 2**32),
    st.sampled_from([0.0, 0.002, 0.02]),
    st.tuples(st.integers(0, 89), st.integers(1, 40)),
    st.tuples(st.integers(0, 109), st.integers(1, 40)),
)
def test_a_field_that_was_updated_is_as_if_made_anew(
    seed: int, share: float, rows: tuple[int, int], cols: tuple[int, int]
) -> None:
    random = np.random.default_rng(seed)
    walls, blocking = random.random(SHAPE) < share, random.random(SHAPE) < share
    field = WallField(SPEC, walls, blocking)
    window = slice(rows[0], min(90, sum(rows))), slice(cols[0], min(110, sum(cols)))
    size = walls[window].shape
    walls[window], blocking[window] = random.random(size) < 3 * share, random.random(size) < 3 * share
    field.update(walls, blocking, window)
    anew = WallField(SPEC, walls, blocking)
    np.testing.assert_array_equal(field.codes, anew.codes)
    np.testing.assert_array_equal(field.skips, anew.skips)
