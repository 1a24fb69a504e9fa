"""Numbers on the command line: what cannot be meant is wrong usage, said before anybody is asked."""

import math
from argparse import ArgumentTypeError
from collections.abc import Callable
from typing import Any

from robotd.core.bounds import bounds_of


def number(text: str) -> float:
    """Return a number, which NaN and infinity are not."""
    try:
        value = float(text)
    except ValueError:
        raise ArgumentTypeError(f"must be a number, got {text}") from None
    if not math.isfinite(value):
        raise ArgumentTypeError(f"must be a finite number, got {text}")
    return value


def positive(text: str) -> float:
    """Return a positive number."""
    value = number(text)
    if value <= 0.0:
        raise ArgumentTypeError(f"must be positive, got {text}")
    return value


def between(lowest: float, highest: float, unit: str) -> Callable[[str], float]:
    """Return what reads a number of this unit within bounds, both included."""

    def bounded(text: str) -> float:
        value = number(text)
        if not lowest <= value <= highest:
            raise ArgumentTypeError(f"must be {lowest:g} to {highest:g} {unit}, got {text}")
        return value

    return bounded


def within(kind: Any, field: str) -> Callable[[str], float]:
    """Return what reads a number that a field of a settings dataclass may hold."""
    bounds = bounds_of(kind)[field]

    def bounded(text: str) -> float:
        value = number(text)
        complaint = bounds.complaint(value)
        if complaint is not None:
            raise ArgumentTypeError(complaint)
        return value

    return bounded


def whole(lowest: int, highest: int | None = None) -> Callable[[str], int]:
    """Return what reads a whole number of at least ``lowest``, and at most ``highest``."""

    def count(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            raise ArgumentTypeError(f"must be a whole number, got {text}") from None
        if value < lowest:
            raise ArgumentTypeError(f"must be at least {lowest}, got {text}")
        if highest is not None and value > highest:
            raise ArgumentTypeError(f"must be at most {highest}, got {text}")
        return value

    return count


def heading_of_deg(degrees: float) -> float:
    """Return a heading [rad] in ``[-pi, pi]``, however often the degrees go round.

    >>> heading_of_deg(-270.0) == heading_of_deg(90.0) == math.pi / 2
    True
    """
    return math.radians(math.remainder(degrees, 360.0))
