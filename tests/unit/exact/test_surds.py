"""Surds are compared exactly, whatever roots they are made of and however they are written."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.exact.rationals import ARITHMETICS, Arithmetic, rational
from robotd.exact.surds import Number, Surd, approximation, compare, enclosure, sign, sqrt
from tests.unit.exact.arithmetics import arithmetics

rationals = st.builds(rational, st.fractions(-50, 50, max_denominator=40), arithmetics)
roots = st.builds(rational, st.integers(0, 60), arithmetics).map(sqrt)


@st.composite
def one_root(draw: st.DrawFn) -> Number:
    return draw(rationals) + draw(rationals) * draw(roots)


@st.composite
def two_storeys(draw: st.DrawFn) -> Number:
    inner = draw(one_root())
    return draw(rationals) + sqrt(inner * inner + draw(st.integers(0, 3)))


numbers = st.one_of(rationals, one_root(), two_storeys())


def by_digits(number: Number, bits: int) -> tuple[Fraction, Fraction]:
    low, high = enclosure(number, bits)
    return Fraction(low, 1 << bits), Fraction(high, 1 << bits)


@settings(max_examples=150, deadline=None)
@given(numbers, numbers)
def test_comparison_agrees_with_a_thousand_digits(one: Number, other: Number) -> None:
    low, high = by_digits(one, 3400)
    other_low, other_high = by_digits(other, 3400)
    if high < other_low:
        assert compare(one, other) == -1
        assert one < other
    elif other_high < low:
        assert compare(one, other) == 1
        assert one > other
    else:
        assert compare(one, other) == 0
        assert one == other


@settings(max_examples=100, deadline=None)
@given(numbers, numbers, numbers)
def test_they_are_a_field(one: Number, two: Number, three: Number) -> None:
    assert one + two == two + one
    assert one * (two + three) == one * two + one * three
    assert (one - two) + two == one
    if sign(two):
        assert one / two * two == one


@settings(max_examples=100, deadline=None)
@given(numbers)
def test_the_root_of_a_square_is_the_number_without_its_sign(number: Number) -> None:
    assert sqrt(number * number) == (number if sign(number) >= 0 else -number)


@settings(max_examples=100, deadline=None)
@given(numbers)
def test_an_approximation_is_as_good_as_it_says(number: Number) -> None:
    value, error = approximation(number)
    low, high = by_digits(number, 400)
    assert Fraction(value) - Fraction(error) <= high
    assert low <= Fraction(value) + Fraction(error)


def test_an_approximation_is_near_though_large_parts_cancel() -> None:
    large = rational(10**40)
    value, error = approximation(large * sqrt(rational(2)) - large * sqrt(rational(2) + 1 / large) + 3)
    assert value == pytest.approx(3.0 - 2.0**-1.5, abs=1e-12)
    assert error < 1e-12


@pytest.mark.parametrize("arithmetic", ARITHMETICS.values(), ids=ARITHMETICS)
@pytest.mark.parametrize("digits", [89, 91, 170, 340])
def test_numbers_that_no_float_comes_near_are_compared_all_the_same(arithmetic: Arithmetic, digits: int) -> None:
    huge, tiny = arithmetic(10**digits), arithmetic(1, 10**digits)
    for number in (huge, tiny, huge * sqrt(arithmetic(2)), tiny * sqrt(arithmetic(2))):
        half = number / 2
        assert 0 < half < number == half + half
        assert -number < -half < 0
        assert compare(number * number, half * number) == 1
        assert sign(number - half - half) == 0
    assert tiny < 1 < huge


def test_roots_that_are_sums_of_others_are_recognized() -> None:
    two, three, six = (sqrt(rational(number)) for number in (2, 3, 6))
    assert two * three == six
    assert sqrt(5 + 2 * six) == two + three
    assert 1 / (two * three - six + 1) == 1
    assert sign(sqrt(5 + 2 * six) - two - three - rational("1e-60")) == -1


def hidden_zero() -> Surd:
    zero = sqrt(rational(2)) * sqrt(rational(3)) - sqrt(rational(6))
    assert isinstance(zero, Surd)
    return zero


def test_the_root_of_a_surd_that_is_zero_is_zero() -> None:
    assert sign(sqrt(hidden_zero())) == 0
    assert sign(1 + sqrt(hidden_zero()) - 1) == 0


def test_a_surd_that_is_zero_divides_nothing() -> None:
    zero = hidden_zero()
    with pytest.raises(ZeroDivisionError):
        rational(1) / zero


def test_a_negative_number_has_no_root() -> None:
    with pytest.raises(ValueError, match="no real root"):
        sqrt(1 - sqrt(rational(2)))


def test_a_perfect_square_has_a_rational_root() -> None:
    assert not isinstance(sqrt(rational("0.0049")), Surd)
    assert sqrt(rational("0.0049")) == rational("0.07")


@pytest.mark.parametrize("value", ["nan", float("inf"), "three", "1/0", "-1e91", "1e-99999"])
def test_what_is_no_finite_number_is_refused(value: str | float) -> None:
    with pytest.raises(ValueError, match=f"must be a finite number below 1e90, got {value!r}"):
        rational(value)


def test_a_float_is_taken_at_its_word() -> None:
    assert rational(0.1) != rational("0.1")
    assert rational(0.5) == rational("1/2")
