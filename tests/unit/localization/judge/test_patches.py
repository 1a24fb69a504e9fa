"""Readings that end near to each other say the same, and count as one."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from robotd.grid.readings import Readings
from robotd.localization.judge.patches import spots_of, thinned, weights


def fan(ranges_m: NDArray[np.float64], step_rad: float) -> Readings:
    count = len(ranges_m)
    zeros = np.zeros(count)
    return Readings(np.column_stack((step_rad * np.arange(count), ranges_m, zeros, zeros, zeros)))


def test_one_beam_counts_once_and_so_do_twenty_on_the_same_spot() -> None:
    assert weights(fan(np.array([3.0]), 0.1), 0.3).tolist() == [1.0]
    assert weights(fan(np.full(20, 0.3), 1e-4), 0.3).sum() == pytest.approx(1.0, abs=0.01)


def test_beams_far_apart_all_count() -> None:
    assert weights(fan(np.full(12, 4.0), math.tau / 12), 0.3).tolist() == [1.0] * 12


def test_a_wall_counts_by_its_length_however_many_beams_meet_it() -> None:
    sums = [weights(fan(np.full(count, 2.0), math.pi / count), 0.3).sum() for count in (100, 200, 400)]
    assert sums == pytest.approx([math.pi * 2.0 / 0.3] * 3, rel=0.07)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32), st.floats(0.05, 0.5), st.integers(1, 80))
def test_thinned_readings_are_apart_in_order_and_not_too_many(seed: int, gap_m: float, most: int) -> None:
    rng = np.random.default_rng(seed)
    readings = fan(rng.uniform(0.3, 8.0, 150), math.tau / 150)[rng.permutation(150)]
    kept = thinned(readings, gap_m, most)
    assert 1 <= len(kept) <= most
    assert (np.diff(kept.bearing_rad) > 0.0).all()
    assert {tuple(row) for row in kept.rows.tolist()} <= {tuple(row) for row in readings.rows.tolist()}
    assert (np.hypot(*np.diff(kept.heads_m, axis=0).T) >= gap_m).all()


def test_misses_side_by_side_count_as_the_piece_of_wall_they_may_be() -> None:
    readings = fan(np.full(60, 1.0), 0.02)
    whole = weights(readings, 0.2).sum()
    readings.rows[20:40, 1], readings.rows[20:40, 4] = 8.0, 1.0
    assert weights(readings, 0.2).sum() == pytest.approx(whole)
    readings.rows[:, 4] = 1.0
    assert np.array_equal(spots_of(readings), readings.heads_m)


def test_a_miss_speaks_of_the_hit_nearest_by_bearing() -> None:
    readings = fan(np.array([1.0, 8.0, 8.0, 3.0, 0.5]), 0.1)
    readings.rows[[1, 2, 4], 4] = 1.0
    assert np.allclose(np.hypot(*spots_of(readings).T), [1.0, 1.0, 3.0, 3.0, 0.5])


def test_no_reading_is_left_out_without_need() -> None:
    readings = fan(np.full(12, 4.0), math.tau / 12)
    assert np.array_equal(thinned(readings, 0.3, 12).rows, readings.rows)
    assert len(thinned(readings[:0], 0.3, 12)) == 0
