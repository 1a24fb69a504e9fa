"""Exact rationals: the standard library's fractions, or gmpy2's where it is installed (extra ``exact``).

Both are numbers of one behaviour; nothing else in the package knows which is in use.
"""

from fractions import Fraction
from typing import TYPE_CHECKING, Final, SupportsFloat

if TYPE_CHECKING:
    Rational = Fraction
else:
    try:
        from gmpy2 import mpq as Rational  # noqa: N812  # it stands for a type of either library
    except ImportError:  # what the extra `exact` installs is wanted for its speed only
        Rational = Fraction

ARITHMETIC: Final = f"{Rational.__module__.partition('.')[0]}.{Rational.__name__}"
"""Which rationals are in use, for reports."""


def rational(value: int | str | Fraction | SupportsFloat) -> Rational:
    """Return a number exactly as it is written: text as a decimal, a float as the binary fraction that it is.

    >>> print(rational("0.1") * 10, rational(0.5))
    1 1/2

    Raises:
        ValueError: it is not a finite number.
    """
    try:
        exact = Fraction(value) if isinstance(value, int | str | Fraction) else _of_number(value)
    except (ValueError, OverflowError, ZeroDivisionError) as error:
        raise ValueError(f"not a finite number: {value!r}") from error
    return Rational(exact.numerator, exact.denominator)


def _of_number(value: SupportsFloat) -> Fraction:
    """Return a float, a number of NumPy's or a rational of whatever kind as a fraction."""
    if isinstance(value, Rational):
        return Fraction(int(value.numerator), int(value.denominator))
    return Fraction(float(value))
