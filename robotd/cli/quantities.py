"""Numbers on the command line: what cannot be meant is wrong usage, said before anybody is asked."""

import math
from argparse import ArgumentTypeError
from collections.abc import Callable


def number(text: str) -> float:
    """Return a number, which NaN and infinity are not."""
    value = float(text)
    if not math.isfinite(value):
        raise ArgumentTypeError(f"must be a finite number, got {text}")
    return value


def positive(text: str) -> float:
    """Return a positive number."""
    value = number(text)
    if value <= 0.0:
        raise ArgumentTypeError(f"must be positive, got {text}")
    return value


def share(text: str) -> float:
    """Return a share of a whole, less than all of it."""
    value = number(text)
    if not 0.0 <= value < 1.0:
        raise ArgumentTypeError(f"must be at least 0 and less than 1, got {text}")
    return value


def whole(lowest: int) -> Callable[[str], int]:
    """Return what reads a whole number of at least ``lowest``."""

    def count(text: str) -> int:
        value = int(text)
        if value < lowest:
            raise ArgumentTypeError(f"must be at least {lowest}, got {text}")
        return value

    return count


def heading_of_deg(degrees: float) -> float:
    """Return a heading [rad] in ``[-pi, pi]``, however often the degrees go round.

    >>> heading_of_deg(-270.0) == heading_of_deg(90.0) == math.pi / 2
    True
    """
    return math.radians(math.remainder(degrees, 360.0))
