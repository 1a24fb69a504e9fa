"""Growing by a disk is the Minkowski sum with it, near and far, at once and after a change."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.grid.footprints import dilate, disk_footprint
from robotd.grid.growth import grown_by_disk, grown_by_disk_updated
from robotd.grid.window import CellWindow

masks = hnp.arrays(
    np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=14), elements=st.sampled_from([False] * 15 + [True])
)
radii = st.sampled_from([0.0, 1.0, 1.5, 3.0, 7.2, 100.0, 100.5])


@settings(max_examples=60)
@given(masks, radii, st.booleans())
def test_it_is_the_minkowski_sum(mask: NDArray[np.bool_], radius: float, outside: bool) -> None:
    expected = dilate(mask, disk_footprint(radius), outside=outside)
    assert np.array_equal(grown_by_disk(mask, radius, outside=outside), expected)


@settings(max_examples=100)
@given(masks, radii, st.booleans(), st.data())
def test_after_a_change_it_is_as_if_grown_from_nothing(
    mask: NDArray[np.bool_], radius: float, outside: bool, data: st.DataObject
) -> None:
    flat = data.draw(st.sets(st.integers(0, mask.size - 1), max_size=3))
    changed = CellWindow.bounding(np.array(sorted(flat), np.intp), mask.shape)
    now = mask.copy()
    now[changed.slices] ^= data.draw(hnp.arrays(np.bool_, now[changed.slices].shape))
    before = grown_by_disk(mask, radius, outside=outside)
    kept = before.copy()
    updated = grown_by_disk_updated(before, now, changed, radius, outside=outside)
    assert np.array_equal(updated, grown_by_disk(now, radius, outside=outside))
    assert np.array_equal(before, kept)


def test_a_negative_radius_is_refused() -> None:
    with pytest.raises(ValueError, match="radius_cells"):
        grown_by_disk(np.zeros((2, 2), np.bool_), -0.5)
