"""Range readings as exact vectors: the paper's z, for a known heading."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from robotd.localization.exact.rationals import Rational, rational
from robotd.localization.exact.surds import Number, sign, sqrt

_NEAR = Rational(1, 2 * 10**9)
"""How far the half angle's tangent may be from what is asked for: directions are then within 1e-9 rad."""


@dataclass(frozen=True, slots=True)
class Beam:
    """A vector from the robot to where its reading ends."""

    dx: Rational
    dy: Rational
    is_hit: bool = True
    """Whether something is at the end. Not for an over-range reading, which has a body only."""

    def __post_init__(self) -> None:
        """Refuse what has no direction."""
        if self.dx == 0 and self.dy == 0:
            raise ValueError("a beam needs a length")

    @property
    def length(self) -> Number:
        """Its length."""
        return sqrt(self.dx * self.dx + self.dy * self.dy)

    def body_share(self, eps: Rational) -> Number:
        """Return how much of it must be free: all but the last eps."""
        share = 1 - eps / self.length
        return share if sign(share) > 0 else Rational(0)

    def turned(self, by: tuple[Rational, Rational]) -> "Beam":
        """Return it for a robot turned by an angle, given by its cosine and sine."""
        cos, sin = by
        return Beam(cos * self.dx - sin * self.dy, sin * self.dx + cos * self.dy, self.is_hit)


def direction(bearing_rad: float) -> tuple[Rational, Rational]:
    """Return the cosine and sine of an angle as a rational point of the unit circle, within 1e-9 of it.

    Quarter turns are exact.

    >>> print(*direction(math.pi / 2))
    0 1
    """
    quarters = round(bearing_rad / (math.pi / 2.0))
    half = rational(math.tan((bearing_rad - quarters * math.pi / 2.0) / 2.0))
    tangent = _simplest(half - _NEAR, half + _NEAR)
    norm = 1 + tangent * tangent
    cos, sin = (1 - tangent * tangent) / norm, 2 * tangent / norm
    for _ in range(quarters % 4):
        cos, sin = -sin, cos
    return cos, sin


def beam(bearing_rad: float, reach: Rational, *, is_hit: bool = True) -> Beam:
    """Return a beam of exactly this length, in the rational direction next to a bearing."""
    cos, sin = direction(bearing_rad)
    return Beam(cos * reach, sin * reach, is_hit)


def theta_slices(beams: Iterable[Beam], headings_rad: Iterable[float]) -> list[tuple[Beam, ...]]:
    """Return the beams for each of some headings: for an unknown one, as many as the answer shall tell apart."""
    fixed = tuple(beams)
    return [tuple(one.turned(turn) for one in fixed) for turn in map(direction, headings_rad)]


def _simplest(low: Rational, high: Rational) -> Rational:
    """Return the fraction of smallest denominator between two: short numbers make fast arithmetic."""
    if high < 0:
        return -_simplest(-high, -low)
    whole = Rational(max(0, math.ceil(low)))
    if whole <= high:
        return whole
    return whole - 1 + 1 / _simplest(1 / (high - whole + 1), 1 / (low - whole + 1))
