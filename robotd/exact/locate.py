"""Whether a point belongs to a set: by its borders, one after the other, O(n)."""

from collections.abc import Callable, Iterable
from functools import cmp_to_key

from robotd.exact.planar import Border, PlanarSet
from robotd.exact.points import Point
from robotd.exact.rationals import rational
from robotd.exact.supports import SupportLine, order_after
from robotd.exact.surds import Number, arithmetic_of, compare


def contains(planar: PlanarSet, point: Point) -> bool:
    """Return whether a point belongs to a set.

    It belongs as a spot says, else as the borders through it say, else as what is above the next border below it.
    """
    for spot in planar.spots:
        if spot.point == point:
            return spot.on
    through = [border for border in planar.borders if _passes(border, point)]
    if through:
        return all(border.on for border in through)
    return below(planar, point)


def below(planar: PlanarSet, point: Point) -> bool:
    """Return whether the points just below a point belong that is on no border of a set."""
    under = [border for border in _meeting(planar.borders, point) if border.support.side(point) > 0]
    return max(under, key=cmp_to_key(_order_at(point.x))).left if under else planar.far


def middle(border: Border) -> Point:
    """Return a point in the middle of a border, or near it and written more simply."""
    start, end = border.start, border.end
    if isinstance(border.support, SupportLine) and border.support.b == 0:
        return Point(start.x, _between(start.y, end.y))
    x = _between(start.x, end.x)
    return Point(x, border.support.height(x))


def _between(low: Number, high: Number) -> Number:
    # The exact middle may have roots, and every predicate on it would pay for them; any point between will do.
    simple = rational((float(low) + float(high)) / 2.0, arithmetic_of(low))
    return simple if compare(low, simple) < 0 < compare(high, simple) else (low + high) / 2


def _passes(border: Border, point: Point) -> bool:
    return border.start <= point <= border.end and border.support.side(point) == 0


def _meeting(borders: Iterable[Border], point: Point) -> list[Border]:
    """Return the borders that the leaning sweep line meets when it is at a point."""
    return [border for border in borders if border.start < point < border.end]


def _order_at(x: Number) -> Callable[[Border, Border], int]:
    """Return the order of borders where they meet the leaning line through a higher point at x."""

    def order(one: Border, other: Border) -> int:
        y = _height(one, x)
        return compare(y, _height(other, x)) or order_after(one.support, other.support, Point(x, y))

    return order


def _height(border: Border, x: Number) -> Number:
    """Return where a border meets a vertical line: at its end there, if it is vertical itself."""
    vertical = isinstance(border.support, SupportLine) and border.support.b == 0
    return border.end.y if vertical else border.support.height(x)
