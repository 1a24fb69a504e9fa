"""Curves know on which side a point is, however small or large the numbers are."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.exact.points import Point
from robotd.exact.rationals import ARITHMETICS, Arithmetic
from robotd.exact.supports import HalfCircle, SupportLine
from robotd.exact.surds import sign

EXPONENTS = st.sampled_from([-330, -170, -162, -90, 0, 90, 160, 310])


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(list(ARITHMETICS.values())),
    EXPONENTS,
    EXPONENTS,
    st.lists(st.integers(-3, 3), min_size=5, max_size=5),
)
def test_sides_are_exact_where_floats_overflow_and_where_they_vanish(
    arithmetic: Arithmetic, scale: int, slope: int, numbers: list[int]
) -> None:
    of_a, of_c, of_x, of_y, of_r2 = (arithmetic(number) for number in numbers)
    unit, steep = (arithmetic(10) ** exponent for exponent in (scale, slope))
    point = Point(of_x * unit, of_y * unit)
    line = SupportLine(of_a * steep, arithmetic(1), of_c * unit)
    assert line.side(point) == sign(line.a * point.x + point.y - line.c)
    circle = HalfCircle(arithmetic(0), arithmetic(0), (1 + abs(of_r2)) * unit * unit, upper=True)
    assert circle.outside(point) == sign(point.x * point.x + point.y * point.y - circle.r2)


@pytest.mark.parametrize("arithmetic", ARITHMETICS.values(), ids=ARITHMETICS)
def test_a_point_within_the_smallest_circle_is_within_it(arithmetic: Arithmetic) -> None:
    # As floats, the squares of the coordinates sum to twice the square of the radius.
    at = arithmetic(192, 10**164)
    circle = HalfCircle(arithmetic(0), arithmetic(0), arithmetic(741, 10**326), upper=True)
    assert circle.outside(Point(at, at)) == -1
