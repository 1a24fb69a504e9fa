"""The arrangement of point sets by force: every border against every other, O(n^2) and more; the sweep's slow twin.

Nothing is shared with the sweep but the numbers and the predicates: borders are cut where any other meets them,
and the sets that contain a piece are asked one by one at its middle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from robotd.exact.arrangement import Arrangement, Mask
from robotd.exact.locate import below, contains, middle
from robotd.exact.planar import Border, PlanarSet
from robotd.exact.points import Point
from robotd.exact.supports import crossings


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A piece of a border that nothing else meets, and the sets that contain it and what is on either side."""

    start: Point
    end: Point
    right: Mask
    on: Mask
    left: Mask


def vertices(sets: Sequence[PlanarSet]) -> list[tuple[Point, Mask]]:
    """Return all points where borders end or meet and all spots, in the order of a sweep, and who contains them."""
    points = _distinct(_all_points(sets))
    return [(at, sum(1 << number for number, planar in enumerate(sets) if contains(planar, at))) for at in points]


def parts(sets: Sequence[PlanarSet]) -> list[Part]:
    """Return all pieces of borders between vertices, those on each other once."""
    points = _distinct(_all_points(sets))
    found: list[tuple[Border, Point]] = []
    for border in _borders(sets):
        on_it = [at for at in points if border.start <= at <= border.end and border.support.side(at) == 0]
        for start, end in pairwise(on_it):
            piece = Border(border.support, start, end, border.right, border.on, border.left)
            # Told apart by their middles: two arcs can have both ends in common and yet be two.
            at = middle(piece)
            if not any(other.start == start and other.end == end and other.support.side(at) == 0 for other, _ in found):
                found.append((piece, at))
    return [_part(sets, piece, at) for piece, at in found]


def parts_of(arrangement: Arrangement) -> list[Part]:
    """Return the edges of an arrangement in the same form."""
    at = [vertex.point for vertex in arrangement.vertices]
    faces = arrangement.faces
    return [Part(at[e.start], at[e.end], faces[e.right], e.mask, faces[e.left]) for e in arrangement.edges]


def _part(sets: Sequence[PlanarSet], piece: Border, at: Point) -> Part:
    right = on = left = 0
    for number, planar in enumerate(sets):
        own = next((b for b in planar.borders if b.start < at < b.end and b.support.side(at) == 0), None)
        inside = own is None and below(planar, at)
        right |= (own.right if own else inside) << number
        on |= (own.on if own else inside) << number
        left |= (own.left if own else inside) << number
    return Part(piece.start, piece.end, right, on, left)


def _all_points(sets: Sequence[PlanarSet]) -> list[Point]:
    borders = _borders(sets)
    points = [end for border in borders for end in (border.start, border.end)]
    points.extend(spot.point for planar in sets for spot in planar.spots)
    for number, one in enumerate(borders):
        for other in borders[:number]:
            points.extend(at for at in crossings(one.support, other.support) if _within(at, one) and _within(at, other))
    return points


def _within(point: Point, border: Border) -> bool:
    return border.start <= point <= border.end


def _borders(sets: Sequence[PlanarSet]) -> list[Border]:
    return [border for planar in sets for border in planar.borders]


def _distinct(points: Sequence[Point]) -> list[Point]:
    ordered = sorted(points)
    return [point for number, point in enumerate(ordered) if number == 0 or point != ordered[number - 1]]
