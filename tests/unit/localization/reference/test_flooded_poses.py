"""Feasible poses by floods against those by convolution."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.footprints import dilate, disk_footprint
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.reference.feasible_poses import blocked_set, endpoint_set, feasible_poses
from robotd.localization.reference.flooded_poses import (
    flooded_blocked_set,
    flooded_endpoint_set,
    flooded_feasible_poses,
)
from robotd.localization.reference.probe import Probe, probe_of

RESOLUTION_M = 0.25
small_maps = hnp.arrays(
    np.bool_, hnp.array_shapes(min_dims=2, max_dims=2, max_side=14), elements=st.sampled_from([False] * 8 + [True])
)
large_maps = st.builds(
    lambda seed, rows, cols: np.random.default_rng(seed).random((rows, cols)) < 0.004,
    st.integers(0, 2**32),
    st.integers(40, 90),
    st.integers(40, 90),
)
bearings = st.one_of(st.floats(-math.pi, math.pi), st.builds(math.atan2, st.integers(-6, 6), st.integers(-6, 6)))
readings = st.builds(
    RangeReading,
    st.just(0),
    bearings,
    st.sampled_from([ReadingStatus.OK, ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.01, 9.0),
    origin_x_m=st.sampled_from([0.0, 0.0, 0.25, 0.3, -0.6]),
    origin_y_m=st.sampled_from([0.0, 0.0, 0.4]),
)


def drawn_at(reading: RangeReading, occupied: NDArray[np.bool_], error_cells: int) -> Probe:
    return probe_of(
        reading,
        0.0,
        resolution_m=RESOLUTION_M,
        error_radius_cells=error_cells + 0.5,
        reach_cells=2 * max(occupied.shape),
    )


@settings(max_examples=200)
@given(small_maps, readings, st.integers(0, 5))
def test_the_blocked_set_is_the_convolutions_200_cases(
    occupied: NDArray[np.bool_], reading: RangeReading, error_cells: int
) -> None:
    body = drawn_at(reading, occupied, error_cells).body
    assert np.array_equal(flooded_blocked_set(occupied, body), blocked_set(occupied, body))


@settings(max_examples=40)
@given(large_maps, readings)
def test_on_larger_maps_it_is_too_40_cases(occupied: NDArray[np.bool_], reading: RangeReading) -> None:
    body = drawn_at(reading, occupied, 0).body
    assert np.array_equal(flooded_blocked_set(occupied, body), blocked_set(occupied, body))


@settings(max_examples=150)
@given(small_maps, readings, st.integers(0, 5))
def test_up_to_five_cells_feasible_poses_are_identical_150_cases(
    occupied: NDArray[np.bool_], reading: RangeReading, error_cells: int
) -> None:
    probe = drawn_at(reading, occupied, error_cells)
    by_convolution = feasible_poses(Obstacles.of(occupied, error_cells + 0.5), probe)
    assert np.array_equal(flooded_feasible_poses(occupied, probe, error_cells), by_convolution)


def grown_by(occupied: NDArray[np.bool_], radius_cells: float) -> NDArray[np.bool_]:
    return dilate(occupied, disk_footprint(radius_cells), outside=True)


@settings(max_examples=60)
@given(large_maps, readings, st.integers(6, 23))
def test_up_to_23_cells_they_differ_only_within_one_cell_of_the_boundary_of_d_60_cases(
    occupied: NDArray[np.bool_], reading: RangeReading, error_cells: int
) -> None:
    probe = drawn_at(reading, occupied, error_cells)
    radius = error_cells + 0.5
    differs = flooded_feasible_poses(occupied, probe, error_cells) != feasible_poses(
        Obstacles.of(occupied, radius), probe
    )
    if probe.head is None:
        assert not differs.any()
        return
    surely_in = endpoint_set(grown_by(occupied, radius - 1.0), probe.head)
    surely_out = ~endpoint_set(grown_by(occupied, radius + 1.0), probe.head)
    assert not (differs & (surely_in | surely_out)).any()


@given(small_maps, st.tuples(st.integers(-20, 20), st.integers(-20, 20)), st.integers(0, 6))
def test_to_grow_and_then_translate_is_to_translate_and_then_grow(
    occupied: NDArray[np.bool_], head: tuple[int, int], error_cells: int
) -> None:
    """So D may be flooded once for all probes."""
    once = flooded_endpoint_set(occupied, (0, 0), error_cells)
    assert np.array_equal(endpoint_set(once, head), flooded_endpoint_set(occupied, head, error_cells))
