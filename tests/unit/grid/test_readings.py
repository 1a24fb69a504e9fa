"""Readings as an array say what the readings say."""

import math

import numpy as np
import pytest

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.readings import Readings

HIT = RangeReading(7, 0.25, ReadingStatus.OK, 3.5, strength=4, origin_x_m=0.1, origin_y_m=-0.2)
MISS = RangeReading(8, math.pi, ReadingStatus.MISS, 6.0)


def test_every_measured_reading_is_a_row_and_every_number_a_column() -> None:
    readings = Readings.of((HIT, MISS))
    assert readings.rows.tolist() == [[0.25, 3.5, 0.1, -0.2, 0.0], [math.pi, 6.0, 0.0, 0.0, 1.0]]
    assert readings.bearing_rad.tolist() == [0.25, math.pi]
    assert readings.range_m.tolist() == [3.5, 6.0]
    assert (readings.start_x_m.tolist(), readings.start_y_m.tolist()) == ([0.1, 0.0], [-0.2, 0.0])
    assert (readings.is_hit.tolist(), readings.is_miss.tolist()) == ([True, False], [False, True])
    assert readings.heads_m[0].tolist() == [0.1 + 3.5 * math.cos(0.25), -0.2 + 3.5 * math.sin(0.25)]


def test_no_readings_are_no_rows() -> None:
    assert Readings.of(()).rows.shape == Readings.none().rows.shape == (0, 5)


def test_parts_are_such_as_kernels_take() -> None:
    several = Readings.of((HIT, MISS, HIT, MISS))
    parts = several[::2], several[np.array([3, 0])], several[several.is_hit], several[1:]
    assert [part.is_miss.tolist() for part in parts] == [[False] * 2, [True, False], [False] * 2, [True, False, True]]
    assert all(part.rows.flags.c_contiguous for part in parts)


def test_joined_and_given_other_ranges_the_old_ones_stay_as_they_are() -> None:
    hit, miss = Readings.of((HIT,)), Readings.of((MISS,))
    assert Readings.none().joined(hit).joined(miss).rows.tolist() == Readings.of((HIT, MISS)).rows.tolist()
    assert hit.with_ranges(np.array([1.0])).rows.tolist() == [[0.25, 1.0, 0.1, -0.2, 0.0]]
    assert hit.range_m.tolist() == [3.5]


def test_a_reading_that_measured_nothing_is_named() -> None:
    with pytest.raises(ValueError, match="a weak reading has no range"):
        Readings.of(
            (RangeReading(0, 0.0, ReadingStatus.OK, 1.0), RangeReading(0, 0.0, ReadingStatus.WEAK, None)),
        )
