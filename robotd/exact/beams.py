"""Range readings as exact vectors: the paper's z, for a known heading."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

from robotd.exact.rationals import DEFAULT, Arithmetic, Rational, rational
from robotd.exact.surds import Number, arithmetic_of, sign, sqrt

_NEAR = Fraction(1, 2 * 10**9)
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
        # A reading shorter than eps has no body at all.
        return share if sign(share) > 0 else arithmetic_of(self.dx)(0)

    def turned(self, by_rad: float) -> "Beam":
        """Return it for a robot turned by an angle."""
        cos, sin = direction(by_rad, arithmetic_of(self.dx))
        return Beam(cos * self.dx - sin * self.dy, sin * self.dx + cos * self.dy, self.is_hit)


def direction(bearing_rad: float, arithmetic: Arithmetic = DEFAULT) -> tuple[Rational, Rational]:
    """Return the cosine and sine of an angle as a rational point of the unit circle, within 1e-9 of it.

    Quarter turns are exact.

    >>> print(*direction(math.pi / 2))
    0 1
    """
    # Quarter turns go first, and exactly; what is left keeps the tangent of the half angle far from its pole.
    quarters = round(bearing_rad / (math.pi / 2.0))
    half = Fraction(math.tan((bearing_rad - quarters * math.pi / 2.0) / 2.0))
    tangent = _simplest(half - _NEAR, half + _NEAR)
    # A rational tangent of the half angle gives a point on the unit circle itself: turned beams keep their length.
    norm = 1 + tangent * tangent
    cos, sin = (1 - tangent * tangent) / norm, 2 * tangent / norm
    for _ in range(quarters % 4):
        cos, sin = -sin, cos
    return rational(cos, arithmetic), rational(sin, arithmetic)


def beam(bearing_rad: float, reach: Rational, *, is_hit: bool = True) -> Beam:
    """Return a beam of exactly this length, in the rational direction next to a bearing."""
    cos, sin = direction(bearing_rad, arithmetic_of(reach))
    return Beam(cos * reach, sin * reach, is_hit)


def theta_slices(beams: Iterable[Beam], headings_rad: Iterable[float]) -> list[tuple[Beam, ...]]:
    """Return the beams for each of some headings: for an unknown one, as many as the answer shall tell apart."""
    fixed = tuple(beams)
    return [tuple(one.turned(heading_rad) for one in fixed) for heading_rad in headings_rad]


def _simplest(low: Fraction, high: Fraction) -> Fraction:
    """Return the fraction of smallest denominator between two: short numbers make fast arithmetic."""
    if high < 0:
        return -_simplest(-high, -low)
    whole = Fraction(max(0, math.ceil(low)))
    if whole <= high:
        return whole
    return whole - 1 + 1 / _simplest(1 / (high - whole + 1), 1 / (low - whole + 1))
