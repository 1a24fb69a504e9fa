"""The smallest error radius for which a share of the readings agrees somewhere, between two numbers as near as asked.

[BrownDonald2000]_ sec. 2.2.2: the paper conjectures a parametric search; this is the plain one, by halves, over an
exact decision. FP_eps only grows with eps (D grows, E shrinks), so a bracket is a proof: below it no pose explains that
many readings, above it one does.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from robotd.localization.exact.beams import Beam
from robotd.localization.exact.feasible import PolygonMap, best_rank, ranked
from robotd.localization.exact.planar import PlanarSet
from robotd.localization.exact.rationals import Rational


@dataclass(frozen=True, slots=True)
class Bracket:
    """Where the smallest error radius lies: above ``low`` and at most ``high``, or exactly there if they are equal."""

    low: Rational
    high: Rational


def smallest_error(
    obstacles: PlanarSet,
    beams: Sequence[Beam],
    *,
    share: Rational,
    largest: Rational,
    width: Rational,
) -> Bracket | None:
    """Return a bracket of at most a width; None if even the largest error radius is too small.

    Args:
        obstacles: the map, closed.
        beams: Z.
        share: of the readings that must hold together, above 0, up to 1.
        largest: where to begin.
        width: when to end; every halving localizes once.

    Raises:
        ValueError: there are no beams, or the share or the width is impossible.
    """
    if not beams or not 0 < share <= 1 or width <= 0:
        raise ValueError(f"cannot look for a share of {share} of {len(beams)} readings to within {width}")
    needed = math.ceil(share * len(beams))

    def suffices(eps: Rational) -> bool:
        return best_rank(ranked(PolygonMap(obstacles, eps), beams)) >= needed

    if not suffices(largest):
        return None
    low, high = Rational(0), largest
    if suffices(low):
        return Bracket(low, low)
    while high - low > width:
        middle = (low + high) / 2
        low, high = (low, middle) if suffices(middle) else (middle, high)
    return Bracket(low, high)
