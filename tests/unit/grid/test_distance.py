"""The distance transform against every source in turn."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.grid.distance import distance_transform
from robotd.grid.footprints import dilate, disk_footprint

masks = hnp.arrays(
    np.bool_,
    hnp.array_shapes(min_dims=2, max_dims=2, max_side=14),
    elements=st.sampled_from([False] * 15 + [True]),
)


def slow_distances(sources: NDArray[np.bool_], *, outside: bool) -> NDArray[np.float64]:
    padded = np.pad(sources, 1, constant_values=outside)
    points = np.argwhere(padded) - 1
    distances = np.full(sources.shape, np.inf)
    for row, col in np.ndindex(sources.shape):
        for i, j in points.tolist():
            distances[row, col] = min(distances[row, col], np.sqrt(float((row - i) ** 2 + (col - j) ** 2)))
    return distances


@settings(max_examples=120)
@given(masks, st.booleans())
def test_the_distance_is_the_least_over_all_sources_to_the_last_bit_120_cases(
    sources: NDArray[np.bool_], outside: bool
) -> None:
    assert np.array_equal(distance_transform(sources, outside=outside), slow_distances(sources, outside=outside))


@given(masks, st.sampled_from([0.0, 1.0, 1.5, 2.0, 3.0, 5.0, 6.25]), st.booleans())
def test_what_is_near_enough_is_what_growing_by_a_disk_adds(
    sources: NDArray[np.bool_], radius_cells: float, outside: bool
) -> None:
    near = distance_transform(sources, outside=outside) <= radius_cells
    assert np.array_equal(near, dilate(sources, disk_footprint(radius_cells), outside=outside))


def test_without_sources_everything_is_infinitely_far() -> None:
    assert np.isinf(distance_transform(np.zeros((3, 4), np.bool_))).all()
