"""The smallest error radius for which a share of the readings agrees somewhere, between two numbers as near as asked.

[BrownDonald2000]_ sec. 2.2.2: the paper conjectures a parametric search; this is the plain one, by halves, over an
exact decision. FP_eps only grows with eps (D grows, E shrinks), so a bracket is a proof: both its ends are decided
exactly, at ``low`` no pose explains that many readings, at ``high`` one does, and what lies outside follows.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from robotd.exact.beams import Beam
from robotd.exact.feasible import PolygonMap, best_rank, ranked
from robotd.exact.planar import PlanarSet
from robotd.exact.rationals import Rational
from robotd.exact.surds import arithmetic_of


@dataclass(frozen=True, slots=True)
class Bracket:
    """Where the smallest error radius lies: above ``low`` and at most ``high``, or exactly there if they are equal."""

    low: Rational
    """Too small, unless it is ``high``."""
    high: Rational
    """Enough."""
    needed: int
    """How many readings hold together, at least."""
    slices: tuple[int, ...]
    """For which slices ``high`` is enough: the first is 0."""


def smallest_error(
    obstacles: PlanarSet,
    slices: Sequence[Sequence[Beam]],
    *,
    share: Rational,
    largest: Rational,
    width: Rational,
) -> Bracket | None:
    """Return a bracket of at most a width; None if even the largest error radius is too small.

    Args:
        obstacles: the map, closed.
        slices: Z, for each heading that it may have been taken at; one, if the heading is known. The bracket is that
            of the best of them, and those that fell out at a larger radius are not asked again.
        share: of the readings that must hold together, above 0, up to 1.
        largest: where to begin.
        width: when to end; every halving localizes once for each slice that is left.

    Raises:
        ValueError: there are no beams, or the share or the width is impossible.
    """
    count = len(slices[0]) if slices else 0
    if not count or not 0 < share <= 1 or width <= 0:
        raise ValueError(f"cannot look for a share of {share} of {count} readings to within {width}")
    wanted = share * count
    # Rounded up among whole numbers: as floats, 0.55 of 100 comes out as more than 55.
    needed = -(-int(wanted.numerator) // int(wanted.denominator))

    def enough(eps: Rational, among: Sequence[int]) -> tuple[int, ...]:
        polygon_map = PolygonMap(obstacles, eps)
        return tuple(number for number in among if best_rank(ranked(polygon_map, slices[number])) >= needed)

    left = enough(largest, range(len(slices)))
    if not left:
        return None
    low, high = arithmetic_of(largest)(0), largest
    # Zero is asked by itself, since halving never gets there.
    exact = enough(low, left)
    if exact:
        return Bracket(low, low, needed, exact)
    while high - low > width:
        middle = (low + high) / 2
        still = enough(middle, left)
        low, high, left = (low, middle, still) if still else (middle, high, left)
    return Bracket(low, high, needed, left)
