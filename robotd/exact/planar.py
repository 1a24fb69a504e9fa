"""Point sets of the plane by their borders: open, closed or neither, with areas, curves and single points.

A set is what its borders and spots say: on either side of a border, and on it, points belong or do not belong. So a
closed polygon, an open one, a parallelogram with one of its sides, a segment and a point are all one type, and so is
whatever can be made of them by union, intersection and difference.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from robotd.exact.points import Point
from robotd.exact.rationals import Rational
from robotd.exact.supports import HalfCircle, Support, SupportLine
from robotd.exact.surds import Number, Surd, sqrt


@dataclass(frozen=True, slots=True, eq=False)
class Border:
    """A piece of a support between two points, without them, and what belongs to the set there."""

    support: Support
    start: Point
    """The end that comes first: by x, then by y."""
    end: Point
    right: bool
    """Whether the points below it belong; right of it, if it is vertical."""
    on: bool
    left: bool
    """Whether the points above it belong; left of it, if it is vertical."""

    def moved(self, dx: Rational, dy: Rational) -> "Border":
        """Return the border this far away."""
        start, end = self.start.moved(dx, dy), self.end.moved(dx, dy)
        return Border(self.support.moved(dx, dy), start, end, self.right, self.on, self.left)


@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """A point, and whether it belongs."""

    point: Point
    on: bool


@dataclass(frozen=True, slots=True, eq=False)
class PlanarSet:
    """A set of points of the plane, by its edges, its single points, and whether it holds what lies far away."""

    borders: tuple[Border, ...] = ()
    """They may meet at their ends only."""
    spots: tuple[Spot, ...] = field(default=())
    """Single points. An end of borders belongs if all of them do, unless a spot there says otherwise."""
    far: bool = False
    """Whether points far away belong."""

    def moved(self, dx: Rational, dy: Rational) -> "PlanarSet":
        """Return the set this far away."""
        spots = tuple(Spot(spot.point.moved(dx, dy), spot.on) for spot in self.spots)
        return PlanarSet(tuple(border.moved(dx, dy) for border in self.borders), spots, self.far)


def segment(start: Point, end: Point, *, on: bool, left: bool, right: bool) -> Border:
    """Return a straight border that runs from a point to another; left and right are those of that way.

    Raises:
        ValueError: the points are one, or the line through them has an irrational slope.
    """
    if end < start:
        start, end, left, right = end, start, right, left
    return Border(_line_through(start, end), start, end, right, on, left)


def edge_along(line: SupportLine, start: Point, end: Point, *, on: bool, left: bool, right: bool) -> Border:
    """Return a border on a known line, from a point of it to another."""
    if end < start:
        start, end, left, right = end, start, right, left
    return Border(line, start, end, right, on, left)


def line_of(border: Border) -> SupportLine:
    """Return the line of a straight border.

    Raises:
        ValueError: it is an arc.
    """
    if isinstance(border.support, SupportLine):
        return border.support
    raise ValueError("an arc has no line")


def disk(centre: Point, radius: Number, *, closed: bool) -> PlanarSet:
    """Return a disk.

    Raises:
        ValueError: the centre or the square of the radius is not rational.
    """
    x, y, r2 = _rational(centre.x), _rational(centre.y), _rational(radius * radius)
    west, east = Point(x - radius, y), Point(x + radius, y)
    upper = Border(HalfCircle(x, y, r2, upper=True), west, east, right=True, on=closed, left=False)
    lower = Border(HalfCircle(x, y, r2, upper=False), west, east, right=False, on=closed, left=True)
    return PlanarSet((upper, lower))


def area_within(rings: Iterable[Sequence[Point]], *, closed: bool) -> PlanarSet:
    """Return what lies left of all rings: outer ones run counter-clockwise, holes clockwise."""
    sides = (pair for ring in rings for pair in zip(ring, (*ring[1:], ring[0]), strict=True))
    return PlanarSet(tuple(segment(*pair, on=closed, left=True, right=False) for pair in sides))


def twice_area(ring: Sequence[Point]) -> Number | int:
    """Return twice the area of a polygon, positive if it runs counter-clockwise."""
    pairs = zip(ring, (*ring[1:], ring[0]), strict=True)
    return sum(one.x * other.y - other.x * one.y for one, other in pairs)


def length(dx: Number, dy: Number) -> Number:
    """Return the length of a vector."""
    return sqrt(dx * dx + dy * dy)


def _line_through(start: Point, end: Point) -> SupportLine:
    dx, dy = _rational(end.x - start.x), _rational(end.y - start.y)
    if dx == dy == 0:
        raise ValueError(f"a border needs two ends, got {start} twice")
    return SupportLine.through(start, dx, dy)


def _rational(number: Number) -> Rational:
    if isinstance(number, Surd):
        raise ValueError(f"{number} is not rational")  # noqa: TRY004  # the right type, but the wrong kind of number
    return number
