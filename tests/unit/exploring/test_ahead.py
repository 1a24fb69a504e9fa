"""A look along a leg: what is in the way, and what only stands beside it."""

import math

import pytest

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.exploring.ahead import bearings_about, bearings_along, head_m, in_the_way, shape_of

HALF_M = 0.3


def hit(x_m: float, y_m: float, status: ReadingStatus = ReadingStatus.OK) -> RangeReading:
    return RangeReading(0, math.atan2(y_m, x_m), status, math.hypot(x_m, y_m))


@pytest.mark.parametrize("length_m", [0.05, 0.3, 1.0, 1.5, 4.0])
def test_beams_cover_the_breadth_of_the_robot_at_the_end_of_the_leg(length_m: float) -> None:
    bearings_rad = bearings_along(length_m, HALF_M)
    assert list(bearings_rad) == sorted(set(bearings_rad))
    assert 0.0 in bearings_rad
    assert [-bearing_rad for bearing_rad in reversed(bearings_rad)] == list(bearings_rad)
    least_rad = min(abs(bearing_rad) for bearing_rad in bearings_rad if bearing_rad)
    assert (length_m + HALF_M) * math.sin(least_rad) == pytest.approx(HALF_M)


@pytest.mark.parametrize(
    ("place_m", "is_met"),
    [
        ((1.0, 0.0), True),
        ((1.0, 0.29), True),
        ((1.0, -0.31), False),
        ((1.75, 0.0), True),
        ((1.85, 0.0), False),
        ((-1.0, 0.0), False),
        ((0.2, 0.2), False),
    ],
    ids=["ahead", "at its edge", "beside", "where its front comes to rest", "beyond", "behind", "beside it already"],
)
def test_what_is_met(place_m: tuple[float, float], is_met: bool) -> None:
    met = in_the_way([hit(*place_m)], 1.5, HALF_M)
    assert (met is not None) == is_met


def test_the_nearest_is_told_and_misses_are_not() -> None:
    far, near, miss = hit(1.2, 0.0), hit(0.8, 0.1), hit(0.6, 0.0, ReadingStatus.MISS)
    assert in_the_way([far, near, miss], 1.5, HALF_M) is near


def test_a_second_look_says_how_broad_it_is_or_that_the_first_was_wrong() -> None:
    first = hit(1.0, 0.1)
    bearings_rad = bearings_about(first.bearing_rad)
    assert first.bearing_rad in bearings_rad
    assert list(bearings_rad) == sorted(bearings_rad)
    box = [hit(1.0, -0.2), hit(1.03, 0.1), hit(1.0, 0.4), hit(3.0, 0.0), hit(1.0, 0.0, ReadingStatus.MISS)]
    assert shape_of(first, box) == tuple(pytest.approx(head_m(one)) for one in box[:3])
    assert shape_of(first, [hit(1.4, 0.1), hit(0.5, 0.1)]) == ()
