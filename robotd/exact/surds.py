"""Numbers that square roots can make of rationals, with exact sign and comparison.

A :class:`Surd` is ``a + b sqrt(c)``. Where arcs and lines of rational coefficients meet, a, b and c are rational: the
*one-root numbers*. A line at a rational distance from one of irrational length already has a root in its
equation, and where it meets a circle there is a root under the root; so a, b and c may themselves be surds. Surds of
different roots are added and multiplied as polynomials in these: the root of the greater key is the outer one.

The sign of ``a + b sqrt(c)`` is that of a and b where they agree, else that of ``a^2 - b^2 c`` decides: one root less.
It does not matter whether a root is secretly a sum of others, so there is no normal form and none is needed. Before
that comes a filter: an enclosure in floats, then one of 320 binary digits, tells the sign of what is not next to zero.
"""

import math
from functools import total_ordering

from robotd.exact.rationals import ARITHMETICS, Arithmetic, Rational

Key = tuple[int, ...]
"""What roots are ordered by: depth first, so that a radicand has only smaller roots."""

_COARSE_BITS = 96
"""Binary digits with which an approximation begins; they are doubled until they are enough."""
_SURE_BITS = 60
"""An approximation is good to this many digits after the point, more than a float near 1 has."""
_FINE_BITS = 320
"""Digits of the last filter before arithmetic that is exact, and slow."""
_RATIONALS: tuple[type[Rational], ...] = tuple(type(arithmetic(0)) for arithmetic in ARITHMETICS.values())
_ROUNDING = 2.0**-51
"""More than the relative error of one float operation or conversion."""
_LEAST, _MOST = 2.0**-300, 2.0**300
"""Floats between these can be multiplied, squared and subtracted in a predicate: nothing vanishes or overflows."""


class Radical:
    """The positive root of a positive number that has no rational root."""

    __slots__ = ("_enclosures", "key", "radicand")

    def __init__(self, radicand: "Number") -> None:
        self.radicand = radicand
        self.key: Key = _key(radicand)
        self._enclosures: dict[int, tuple[int, int]] = {}

    def enclosure(self, bits: int) -> tuple[int, int]:
        """Return whole numbers around the root times ``2 ** bits``."""
        # One root stands in many numbers, and each of them asks for it again.
        if bits not in self._enclosures:
            low, high = enclosure(self.radicand, bits)
            self._enclosures[bits] = math.isqrt(max(low, 0) << bits), math.isqrt(max(high, 0) << bits) + 1
        return self._enclosures[bits]


@total_ordering
class Surd:
    """``a + b * root``, immutable; a and b have only roots of smaller keys."""

    __slots__ = ("_approximation", "a", "b", "root")
    __hash__ = None  # type: ignore[assignment]  # equal numbers can be written in different ways

    def __init__(self, a: "Number", b: "Number", root: Radical) -> None:
        self.a, self.b, self.root = a, b, root
        self._approximation: tuple[float, float] | None = None

    def __repr__(self) -> str:
        return f"({self.a} + {self.b} sqrt({self.root.radicand}))"

    def __add__(self, other: "Number | int") -> "Number":
        if not isinstance(other, Surd) or self.root.key > other.root.key:
            return Surd(self.a + other, self.b, self.root)
        if self.root.key == other.root.key:
            return _surd(self.a + other.a, self.b + other.b, self.root)
        return Surd(self + other.a, other.b, other.root)

    def __mul__(self, other: "Number | int") -> "Number":
        if not isinstance(other, Surd) or self.root.key > other.root.key:
            return _surd(self.a * other, self.b * other, self.root)
        if self.root.key == other.root.key:
            a = self.a * other.a + self.b * other.b * self.root.radicand
            return _surd(a, self.a * other.b + self.b * other.a, self.root)
        return _surd(self * other.a, self * other.b, other.root)

    def __neg__(self) -> "Surd":
        return Surd(-self.a, -self.b, self.root)

    def __sub__(self, other: "Number | int") -> "Number":
        return self + -other

    def __rsub__(self, other: Rational | int) -> "Number":
        return -self + other

    def __truediv__(self, other: "Number | int") -> "Number":
        if isinstance(other, Surd):
            return self * other.inverse()
        return Surd(self.a / other, self.b / other, self.root)

    def __rtruediv__(self, other: Rational | int) -> "Number":
        return self.inverse() * other

    __radd__ = __add__
    __rmul__ = __mul__

    def inverse(self) -> "Number":
        """Return 1 divided by this.

        Raises:
            ZeroDivisionError: it is zero.
        """
        norm = self._norm()
        if sign(norm) != 0:
            return _surd(self.a, -self.b, self.root) / norm
        if sign(self) == 0:
            raise ZeroDivisionError("division by a surd that is zero")
        return 1 / (self.a + self.a)  # then a = b root, though written differently

    def __eq__(self, other: object) -> bool:
        is_number = isinstance(other, (int, Surd, *_RATIONALS))
        return is_number and compare(self, other) == 0  # type: ignore[arg-type]  # what has just been asked

    def __lt__(self, other: "Number | int") -> bool:
        return compare(self, other) < 0

    def __float__(self) -> float:
        return self._approximated()[0]

    def approximation(self) -> tuple[float, float]:
        """Return the number as a float, and a bound on its error."""
        if self._approximation is None:
            try:
                value, error = self._approximated()
            except OverflowError:
                value, error = math.inf, math.inf
            self._approximation = (value, error) if _LEAST < abs(value) < _MOST else _beyond_floats(value, error)
        return self._approximation

    def _approximated(self) -> tuple[float, float]:
        """Look closer until the error is below 2^-60: large parts can cancel each other."""
        bits = _COARSE_BITS
        low, high = enclosure(self, bits)
        while high - low >= 1 << (bits - _SURE_BITS):
            bits *= 2
            low, high = enclosure(self, bits)
        value, width = low / (1 << bits), (high - low + 1) / (1 << bits)
        return value, width * (1.0 + _ROUNDING) + abs(value) * _ROUNDING

    def sign(self) -> int:
        """Return -1, 0 or 1."""
        value, error = self.approximation()
        if abs(value) > error:
            return 1 if value > 0.0 else -1
        low, high = enclosure(self, _FINE_BITS)
        if low > 0 or high < 0:
            return 1 if low > 0 else -1
        of_a, of_b = sign(self.a), sign(self.b)
        if of_a * of_b >= 0:
            return of_a or of_b
        return of_a * sign(self._norm())

    def _norm(self) -> "Number":
        return self.a * self.a - self.b * self.b * self.root.radicand


Number = Rational | Surd


def arithmetic_of(number: Number) -> Arithmetic:
    """Return what the rationals are that a number is made of."""
    while isinstance(number, Surd):
        number = number.a
    return type(number)


def sign(number: Number | int) -> int:
    """Return -1, 0 or 1."""
    if isinstance(number, Surd):
        return number.sign()
    return (number > 0) - (number < 0)


def compare(one: Number | int, other: Number | int) -> int:
    """Return the sign of ``one - other``."""
    if one is other:
        return 0
    value, error = approximation(one)
    other_value, other_error = approximation(other)
    apart = value - other_value
    if abs(apart) * (1.0 - _ROUNDING) > (error + other_error) * (1.0 + _ROUNDING):
        return 1 if apart > 0.0 else -1
    return sign(one - other)


def sqrt(number: Number) -> Number:
    """Return the root; rational if there is a rational one.

    >>> print(sqrt(Rational(9, 4)))
    3/2

    Raises:
        ValueError: the number is negative.
    """
    sense, arithmetic = sign(number), arithmetic_of(number)
    if sense < 0:
        raise ValueError("no real root of a negative number")
    if sense == 0:
        return arithmetic(0)
    if isinstance(number, Surd):
        return Surd(arithmetic(0), arithmetic(1), Radical(number))
    factor, radicand = _without_squares(int(number.numerator) * int(number.denominator))
    whole = math.isqrt(radicand)
    scale = arithmetic(factor, int(number.denominator))
    if whole * whole == radicand:
        return scale * whole
    return Surd(arithmetic(0), scale, Radical(arithmetic(radicand)))


def approximation(number: Number | int) -> tuple[float, float]:
    """Return a number as a float, and a bound on its error: infinite, with no float at all, if it is very large."""
    if isinstance(number, Surd):
        return number.approximation()
    try:
        value = float(number)
    except OverflowError:
        value = math.inf
    size = abs(value)
    if _LEAST < size < _MOST or number == 0:
        return value, size * _ROUNDING
    return _beyond_floats(value, 0.0)


def _beyond_floats(value: float, error: float) -> tuple[float, float]:
    """Return what is known of a number that vanishes or overflows when floats are multiplied."""
    return 0.0, (error + _LEAST if abs(value) <= _LEAST else math.inf)


def enclosure(number: Number, bits: int) -> tuple[int, int]:
    """Return whole numbers around a number times ``2 ** bits``."""
    if not isinstance(number, Surd):
        low = (int(number.numerator) << bits) // int(number.denominator)
        return low, low + 1
    low, high = enclosure(number.a, bits)
    of_b, of_root = enclosure(number.b, bits), number.root.enclosure(bits)
    # Of two intervals, the ends of the product are among the products of their ends.
    products = [one * other for one in of_b for other in of_root]
    return low + (min(products) >> bits), high + (max(products) >> bits) + 1


def _surd(a: Number, b: Number, root: Radical) -> Number:
    return a if not isinstance(b, Surd) and b == 0 else Surd(a, b, root)


def _key(radicand: Number) -> Key:
    depth, terms = _terms(radicand)
    return (depth, *terms)


def _terms(number: Number) -> tuple[int, Key]:
    """Return how many roots stand in each other at most, counting one around the number; and all its integers."""
    if not isinstance(number, Surd):
        return 1, (int(number.numerator), int(number.denominator))
    depths, parts = zip(*(_terms(part) for part in (number.a, number.b, number.root.radicand)), strict=True)
    return max(depths[0], depths[1], depths[2] + 1), (0, 0, *parts[0], *parts[1], *parts[2])


def _without_squares(whole: int) -> tuple[int, int]:
    """Return ``(f, w)`` with ``f * f * w`` the number: without the squares that decimal input brings along."""
    factor = 1
    for prime in (2, 3, 5, 7):
        while whole and whole % (prime * prime) == 0:
            whole //= prime * prime
            factor *= prime
    return factor, whole
