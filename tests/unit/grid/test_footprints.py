"""Growing against the definition of the Minkowski sum."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.grid.footprints import dilate, disk_footprint

masks = hnp.arrays(np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=9))
sides = st.sampled_from([1, 3, 5, 7, 9])
footprints = st.tuples(sides, sides).flatmap(lambda shape: hnp.arrays(np.bool_, shape))


def slow_dilate(mask: NDArray[np.bool_], footprint: NDArray[np.bool_], outside: bool) -> NDArray[np.bool_]:
    grown = np.zeros_like(mask)
    for row, col in np.ndindex(mask.shape):
        for i, j in np.argwhere(footprint):
            r, c = row - (i - footprint.shape[0] // 2), col - (j - footprint.shape[1] // 2)
            inside = 0 <= r < mask.shape[0] and 0 <= c < mask.shape[1]
            grown[row, col] |= mask[r, c] if inside else outside
    return grown


@settings(max_examples=150)
@given(masks, footprints, st.booleans())
def test_dilate_is_the_minkowski_sum(mask: NDArray[np.bool_], footprint: NDArray[np.bool_], outside: bool) -> None:
    assert np.array_equal(dilate(mask, footprint, outside=outside), slow_dilate(mask, footprint, outside))


@given(st.floats(0.0, 13.0))
def test_a_disk_is_all_cells_within_the_radius(radius: float) -> None:
    disk = disk_footprint(radius)
    middle = disk.shape[0] // 2
    for row, col in np.ndindex(disk.shape):
        assert disk[row, col] == ((row - middle) ** 2 + (col - middle) ** 2 <= radius**2)
    assert middle + 1 > radius
