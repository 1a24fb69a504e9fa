"""C fits poses, and looks for them on a lattice, as NumPy does."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.kernels.fit.fit_kernel import Lattice
from robotd.grid.kernels.twins import TWINS
from tests.support.kernel_tables import NATIVE, needs_native

pytestmark = needs_native


@settings(max_examples=100, deadline=None)
@given(
    st.integers(0, 2**32),
    st.tuples(st.integers(1, 60), st.integers(1, 60)),
    st.sampled_from([0.0, 0.02, 0.3]),
    st.sampled_from([0, 1, 2, 40]),
    st.sampled_from([0.0, 1e-3, 0.5, 5.0]),
)
def test_poses_and_all_that_is_said_of_them_are_equal(
    seed: int, shape: tuple[int, int], share: float, heads: int, half: float
) -> None:
    random = np.random.default_rng(seed)
    codes = TWINS.cast.wall_codes(random.random(shape) < share)
    distances = np.sqrt(np.abs(np.arange(-128.0, 128.0))) - 0.5 * (seed % 2)
    starts = random.uniform(0.0, 1.0, (3, 3)) * (shape[1], shape[0], 6.0)
    boxes = np.concatenate((starts, starts - half * random.random((3, 3)), starts + half), axis=1)
    arguments = (codes, distances, random.normal(size=(heads, 2)) * 12.0, boxes, 4.0)
    one, other = NATIVE.fit.fit_poses(*arguments), TWINS.fit.fit_poses(*arguments)
    for name in ("poses", "covariances", "quality", "beyond"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=1e-9, atol=1e-9)
    assert (one.poses >= boxes[:, 3:6]).all()
    assert (one.poses <= boxes[:, 6:]).all()


steps = st.tuples(st.integers(-4, 0), st.integers(0, 4)).map(list)


@settings(max_examples=100, deadline=None)
@given(
    st.integers(0, 2**32),
    st.tuples(st.integers(1, 60), st.integers(1, 60)),
    st.sampled_from([0, 1, 30]),
    st.tuples(steps, steps, steps),
    st.integers(1, 3),
)
def test_places_of_a_lattice_cost_the_same_at_the_same_headings(
    seed: int, shape: tuple[int, int], heads: int, bounds: tuple[list[int], list[int], list[int]], step_cells: int
) -> None:
    random = np.random.default_rng(seed)
    codes = TWINS.cast.wall_codes(random.random(shape) < 0.02)
    costs = np.minimum(np.abs(np.arange(-128, 128)), 64).astype(np.int32)
    start = random.uniform(-0.2, 1.2, 3) * (shape[1], shape[0], 6.0)
    lattice = Lattice(start, np.array(bounds, np.int32).ravel(), step_cells, 0.05)
    arguments = (codes, costs, random.normal(size=(heads, 2)) * 12.0, lattice)
    for one, other in zip(NATIVE.fit.scan_poses(*arguments), TWINS.fit.scan_poses(*arguments), strict=True):
        np.testing.assert_array_equal(one, other)
