"""Exact rationals, of whatever library: the arithmetic is a value that a caller passes where numbers are born.

That is where text, floats and directions become numbers. From there on every number knows what it is made of
(:func:`robotd.exact.surds.arithmetic_of`), and literals are plain integers. A map, its readings and its
eps are to be of one arithmetic.
"""

import re
from fractions import Fraction
from importlib import import_module
from typing import Final, Protocol, SupportsFloat

Rational = Fraction
"""What any arithmetic's numbers are written as: they all do what a fraction does."""


class Arithmetic(Protocol):
    """What makes a rational of a numerator and a denominator: the class of its numbers."""

    def __call__(self, numerator: int, denominator: int = 1, /) -> Rational:
        """Return the number."""


_CLASSES = {"gmpy2": "mpq", "flint": "fmpq", "fractions": "Fraction"}
"""Where each arithmetic lives, fastest first; all but the last are extras."""
_HUGE_EXPONENT: Final = re.compile(r"[eE][+-]?[0-9_]{4,}")
_TOO_LARGE: Final = 10**90
"""Anyone who draws or prints a number wants a float, and squares it; just below the 2^300 of :mod:`.surds`' filter."""


def _installed() -> dict[str, Arithmetic]:
    found: dict[str, Arithmetic] = {}
    for module, name in _CLASSES.items():
        try:
            found[module] = getattr(import_module(module), name)
        except ImportError:  # it would be wanted for its speed only
            continue
    return found


ARITHMETICS: Final = _installed()
"""Every arithmetic that is installed, by the name of its module, fastest first."""
DEFAULT: Final = next(iter(ARITHMETICS.values()))
"""The fastest of them: what is used where nobody says otherwise."""


def name_of(arithmetic: Arithmetic) -> str:
    """Return the name of an installed arithmetic, for reports."""
    return next(name for name, installed in ARITHMETICS.items() if installed is arithmetic)


def rational(value: str | SupportsFloat, arithmetic: Arithmetic = DEFAULT) -> Rational:
    """Return a number exactly as it is written: text as a decimal, a float as the binary fraction that it is.

    >>> print(rational("0.1") * 10, rational(0.5))
    1 1/2

    Raises:
        ValueError: it is not a finite number, or too large, or written with a huge exponent.
    """
    impossible = f"must be a finite number below 1e90, got {value!r}"
    try:
        exact = _fraction(value)
    except (ValueError, OverflowError, ZeroDivisionError) as error:
        raise ValueError(impossible) from error
    if abs(exact) >= _TOO_LARGE:
        raise ValueError(impossible)
    return arithmetic(exact.numerator, exact.denominator)


def _fraction(value: str | SupportsFloat) -> Fraction:
    """Return text, a float, an integer, or a rational of whatever arithmetic as a fraction."""
    if isinstance(value, str):
        if _HUGE_EXPONENT.search(value):
            raise ValueError("its digits alone would take for ever")
        return Fraction(value)
    if hasattr(value, "numerator") and hasattr(value, "denominator"):
        return Fraction(int(value.numerator), int(value.denominator))
    return Fraction(float(value))
