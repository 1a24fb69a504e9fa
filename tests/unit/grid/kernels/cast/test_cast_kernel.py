"""Wall fields are what they say, beams go as far as one small step after the other would, and C does as NumPy does."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.grid.distance import distance_transform
from robotd.grid.kernels.cast.cast_kernel import BLOCKS, DEPTH_CELLS, ENDS, REACH_CELLS, SKIP_MAX
from robotd.grid.kernels.twins import TWINS
from tests.support.kernel_tables import NATIVE

Masks = tuple[NDArray[np.bool_], NDArray[np.bool_]]


@st.composite
def masks(draw: st.DrawFn) -> Masks:
    """Return walls and other blocking cells of a small map."""
    shape = draw(st.tuples(st.integers(1, 40), st.integers(1, 40)))
    random = np.random.default_rng(draw(st.integers(0, 2**32)))
    share = draw(st.sampled_from([0.0, 0.005, 0.05, 0.5, 1.0]))
    walls = random.random(shape) < share
    return walls, (random.random(shape) < share) & ~walls


@settings(max_examples=100, deadline=None)
@given(masks())
def test_codes_are_squared_distances_and_c_agrees(drawn: Masks) -> None:
    walls, _ = drawn
    codes = TWINS.cast.wall_codes(walls)
    outside = np.minimum(distance_transform(walls), REACH_CELLS) ** 2
    inside = np.minimum(distance_transform(~walls), DEPTH_CELLS) ** 2
    np.testing.assert_array_equal(codes, np.rint(np.where(walls, -inside, outside)))
    np.testing.assert_array_equal(NATIVE.cast.wall_codes(walls), codes)


@settings(max_examples=100, deadline=None)
@given(masks())
def test_skips_never_pass_what_stops_a_beam_and_c_agrees(drawn: Masks) -> None:
    walls, blocks = drawn
    skips = TWINS.cast.skip_codes(walls, blocks)
    stops = np.pad(walls | blocks, 1, constant_values=True)
    assert ((skips == ENDS) == np.pad(walls, 1)).all()
    assert ((skips == BLOCKS) == (stops & ~np.pad(walls, 1))).all()
    for row, col in np.argwhere(~stops).tolist():
        for reach in range(SKIP_MAX):
            near = stops[max(0, row - reach) : row + reach + 1, max(0, col - reach) : col + reach + 1]
            assert near.any() == (skips[row, col] <= reach)
    np.testing.assert_array_equal(NATIVE.cast.skip_codes(walls, blocks), skips)


places = st.tuples(st.integers(-1_000, 41_000), st.integers(-1_000, 41_000)).map(lambda at: (at[0] / 1e3, at[1] / 1e3))
headings = st.one_of(st.floats(-4.0, 4.0), st.integers(-4, 4).map(lambda k: k * math.pi / 4))


@settings(max_examples=200, deadline=None)
@given(masks(), st.lists(places, min_size=1, max_size=3), st.lists(headings, min_size=1, max_size=8), st.integers(1, 2))
def test_c_casts_beams_to_the_last_bit_as_numpy_does(
    drawn: Masks, starts: list[tuple[float, float]], bearings: list[float], blocked_by: int
) -> None:
    skips = TWINS.cast.skip_codes(*drawn)
    beams = np.array([(0.3, -0.2, math.cos(bearing), math.sin(bearing)) for bearing in bearings])
    poses = np.array([(x, y, math.cos(0.2 * x), math.sin(0.2 * x)) for x, y in starts])
    for one, other in zip(
        NATIVE.cast.cast_beams(skips, beams, poses, blocked_by),
        TWINS.cast.cast_beams(skips, beams, poses, blocked_by),
        strict=True,
    ):
        np.testing.assert_array_equal(one, other)


@settings(max_examples=150, deadline=None)
@given(masks(), places, st.floats(-4.0, 4.0), st.integers(1, 2))
def test_a_beam_goes_as_far_as_small_steps_take_it(
    drawn: Masks, start: tuple[float, float], bearing: float, blocked_by: int
) -> None:
    skips = TWINS.cast.skip_codes(*drawn)
    beams = np.array([(0.0, 0.0, math.cos(bearing), math.sin(bearing))])
    (way,), (stop,) = (
        found[0] for found in TWINS.cast.cast_beams(skips, beams, np.array([(*start, 1.0, 0.0)]), blocked_by)
    )
    expected = stepped(skips, start, bearing, blocked_by)
    # A step may miss a corner that the beam cuts by less.
    if expected is not None:
        assert (way, stop) == (pytest.approx(expected[0], abs=2e-3), expected[1])


def stepped(
    skips: NDArray[np.uint8], start: tuple[float, float], bearing: float, blocked_by: int
) -> tuple[float, int] | None:
    """Return how far a beam goes and what stops it, None if it cuts a corner too closely to say."""
    along = np.arange(0.0, 70.0, 1e-3)
    cols, rows = start[0] + along * math.cos(bearing) + 1.0, start[1] + along * math.sin(bearing) + 1.0
    near_corner = (np.abs(cols - np.rint(cols)) < 2e-3) & (np.abs(rows - np.rint(rows)) < 2e-3)
    col, row = np.floor(cols).astype(int), np.floor(rows).astype(int)
    height, width = skips.shape
    if not (0 < col[0] < width - 1 and 0 < row[0] < height - 1):
        return 0.0, BLOCKS
    met, meets, run = 0, False, (0.0, BLOCKS)
    first_close = int(near_corner.argmax()) if near_corner.any() else len(along)
    for k in [0, *(np.flatnonzero(np.diff(row) | np.diff(col)) + 1).tolist()]:
        if k >= first_close:
            return None
        cell = int(row[k]), int(col[k])
        met_before, code = meets, int(skips[cell])
        meets = code in {ENDS, BLOCKS}
        if meets and not met_before:
            run = (float(along[k]), code)
        met += meets
        at_edge = cell[0] in {0, height - 1} or cell[1] in {0, width - 1}
        if (meets and met >= blocked_by) or at_edge:
            return run
    raise AssertionError("the beam never ends")
