"""Readings as an array say what the readings say."""

import math

import pytest

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.readings import numbers_of


def test_every_measured_reading_is_a_row() -> None:
    hit = RangeReading(7, 0.25, ReadingStatus.OK, 3.5, strength=4, origin_x_m=0.1, origin_y_m=-0.2)
    miss = RangeReading(8, math.pi, ReadingStatus.MISS, 6.0)
    numbers = numbers_of((hit, miss))
    assert numbers.tolist() == [[0.25, 3.5, 0.1, -0.2, 0.0], [math.pi, 6.0, 0.0, 0.0, 1.0]]
    assert numbers.flags.c_contiguous


def test_no_readings_are_no_rows() -> None:
    assert numbers_of(()).shape == (0, 5)


def test_a_reading_that_measured_nothing_is_named() -> None:
    with pytest.raises(ValueError, match="a weak reading has no range"):
        numbers_of(
            (RangeReading(0, 0.0, ReadingStatus.OK, 1.0), RangeReading(0, 0.0, ReadingStatus.WEAK, None)),
        )
