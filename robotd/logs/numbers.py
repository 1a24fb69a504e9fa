"""Numbers as programs print them, and what is no number or no place."""

import math
import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2

_FARTHEST_M = 1e6
"""No log leads farther from where it began."""
_WINDOWS = re.compile(r"([+-]?)1\.#(?:(INF?|J)|(?:IND|QNAN|SNAN|QO|R))0*", re.IGNORECASE)
"""What C on Windows prints for infinity and for no number; rounded to two places, INF is ``#J`` and IND is ``#R``."""


class DamagedLineError(ValueError):
    """A line is not what its first word says; the message says what it lacks."""


def number(text: str) -> float:
    """Return a number, which may be ``nan`` or infinite.

    >>> number("1.50"), number("-nan"), number("1.#INF"), number("-1.#IND")
    (1.5, nan, inf, nan)

    Raises:
        DamagedLineError: it is none.
    """
    try:
        return float(_printed(text))
    except ValueError:
        pass
    found = _WINDOWS.fullmatch(text)
    if found is None:
        raise DamagedLineError(f"{text[:20]!r} is no number")
    sign = -1.0 if found[1] == "-" else 1.0
    return sign * math.inf if found[2] else math.nan


def counted(fields: Sequence[str]) -> tuple[NDArray[np.float64], Sequence[str]]:
    """Return the numbers that the first field announces, ``float64[n]``, and the fields after them.

    Raises:
        DamagedLineError: there are fewer, or one is no number.
    """
    count = whole(fields[0] if fields else "")
    if count < 0 or len(fields) < 1 + count:
        raise DamagedLineError(f"{count} numbers are announced, {len(fields) - 1} follow")
    return np.array([number(text) for text in fields[1 : 1 + count]], dtype=np.float64), fields[1 + count :]


def whole(text: str) -> int:
    """Return a whole number.

    Raises:
        DamagedLineError: it is none.
    """
    try:
        return int(_printed(text))
    except ValueError:
        raise DamagedLineError(f"{text[:20]!r} is no count") from None


def _printed(text: str) -> str:
    """Return what a program may have printed: digits with ``_`` between them are Python's own, and here two words."""
    if "_" in text:
        raise ValueError
    return text


def pose(fields: Sequence[str]) -> Pose2:
    """Return the pose of three fields ``x y heading``, the heading wrapped.

    Raises:
        DamagedLineError: they are fewer, or no place on earth.
    """
    if len(fields) < 3:
        raise DamagedLineError(f"the line ends within a pose: {len(fields)} of 3 numbers")
    x_m, y_m, heading_rad = (number(text) for text in fields[:3])
    if not all(math.isfinite(value) and abs(value) <= _FARTHEST_M for value in (x_m, y_m, heading_rad)):
        raise DamagedLineError(f"{' '.join(fields[:3])[:60]} is no pose: three finite numbers below {_FARTHEST_M:g}")
    return Pose2(x_m, y_m, wrap_rad(heading_rad))
