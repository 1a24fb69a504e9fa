"""The definition of a feasible pose, point by point: cast the beam and see.

[BrownDonald2000]_ sec. 2.2.1, (2) and (4). Exact; it knows nothing of D, E, sweeps and
arrangements, so it is their oracle. And it answers *which readings hold here, and why not the others*.
"""

import enum
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cmp_to_key
from itertools import pairwise

from robotd.exact.beams import Beam
from robotd.exact.locate import contains
from robotd.exact.planar import Border, PlanarSet, line_of
from robotd.exact.points import Point
from robotd.exact.polygons import interior
from robotd.exact.rationals import Rational
from robotd.exact.surds import Number, arithmetic_of, compare, sign, sqrt


class CastOutcome(enum.StrEnum):
    """What becomes of a beam."""

    HOLDS = "holds"
    BLOCKED = "blocked"
    """Its body meets the inside of an obstacle."""
    ENDS_IN_THE_OPEN = "ends_in_the_open"
    """Nothing is within eps of its end."""


@dataclass(frozen=True, slots=True)
class CastVerdict:
    """Whether a reading holds at a point, and how far it is from holding if not."""

    outcome: CastOutcome
    free_length: Number | None = None
    """For a blocked beam: how far it runs before it enters an obstacle."""
    nearest: Number | None = None
    """For one that ends in the open: how far from its end the next obstacle is."""


def cast(obstacles: PlanarSet, beam: Beam, eps: Rational, pose: Point) -> CastVerdict:
    """Return what becomes of a beam from a point of rational or irrational coordinates: O(n k) if it meets k edges."""
    entry = _entry(obstacles, beam, pose)
    # Less, not equal: a body does not hold its end, so it may touch an obstacle there (E is open).
    if entry is not None and compare(entry, beam.body_share(eps)) < 0:
        return CastVerdict(CastOutcome.BLOCKED, free_length=entry * beam.length)
    if contains(interior(obstacles), pose):  # a beam without body begins somewhere all the same
        return CastVerdict(CastOutcome.BLOCKED, free_length=arithmetic_of(beam.dx)(0))
    if beam.is_hit:
        end = pose.moved(beam.dx, beam.dy)
        square = distance_square(obstacles, end)
        if compare(square, eps * eps) > 0:
            return CastVerdict(CastOutcome.ENDS_IN_THE_OPEN, nearest=sqrt(square))
    return CastVerdict(CastOutcome.HOLDS)


def rank_at(obstacles: PlanarSet, beams: Iterable[Beam], eps: Rational, pose: Point) -> int:
    """Return rnk(M, Z, p) of one point."""
    return sum(cast(obstacles, beam, eps, pose).outcome is CastOutcome.HOLDS for beam in beams)


def distance_square(obstacles: PlanarSet, point: Point) -> Number:
    """Return the square of the distance from a point to the map."""
    # Inside it is no distance at all, and the nearest border would say otherwise.
    if contains(obstacles, point):
        return arithmetic_of(point.x)(0)
    squares = (_square(border, point) for border in obstacles.borders)
    return min(squares, key=cmp_to_key(compare))


def _entry(obstacles: PlanarSet, beam: Beam, pose: Point) -> Number | None:
    """Return the least share of the beam after which it is inside an obstacle; None if it never is."""
    inside = interior(obstacles)
    met = [share for border in obstacles.borders for share in _meeting(border, beam, pose)]
    # Inside and outside change only where the beam meets an edge: one point between two such shares answers for all.
    between = [share for share in met if sign(share) > 0 > compare(share, 1)]
    arithmetic = arithmetic_of(beam.dx)
    shares = sorted([arithmetic(0), *between, arithmetic(1)], key=cmp_to_key(compare))
    for start, end in pairwise(shares):
        if compare(start, end) < 0 and contains(inside, _along(beam, (start + end) / 2, pose)):
            return start
    return None


def _meeting(border: Border, beam: Beam, pose: Point) -> Iterator[Number]:
    """Return at what share of the beam it meets an edge; nothing if it runs along: others begin at its ends."""
    line = line_of(border)
    closing = line.a * beam.dx + line.b * beam.dy
    if closing == 0:
        return
    share = (line.c - line.a * pose.x - line.b * pose.y) / closing
    if border.start <= _along(beam, share, pose) <= border.end:
        yield share


def _along(beam: Beam, share: Number, pose: Point) -> Point:
    return pose.moved(share * beam.dx, share * beam.dy)


def _square(border: Border, point: Point) -> Number:
    line = line_of(border)
    for end, sense in ((border.start, -1), (border.end, 1)):
        dx, dy = point.x - end.x, point.y - end.y
        if sign(dx * line.b - dy * line.a) == sense:  # beyond this end
            return dx * dx + dy * dy
    above = line.a * point.x + line.b * point.y - line.c
    return above * above / (line.a * line.a + line.b * line.b)
