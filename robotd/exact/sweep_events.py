"""What a sweep stops at: ends of borders, spots, crossings; all that happens at one point is one event."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from robotd.exact.arrangement import Mask
from robotd.exact.planar import Border, PlanarSet
from robotd.exact.points import Point
from robotd.exact.supports import HalfCircle
from robotd.exact.surds import approximation

_MARGIN = 1e-9
"""Relative slack of the heights that say early that two edges cannot meet; far above the rounding of a float."""


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A border, the set that it belongs to, and between what heights it surely lies."""

    border: Border
    bit: Mask
    low: float
    high: float

    @classmethod
    def of(cls, border: Border, bit: Mask) -> "Piece":
        """Measure a border."""
        lows = [end.y_float - end.y_error for end in (border.start, border.end)]
        highs = [end.y_float + end.y_error for end in (border.start, border.end)]
        if isinstance(border.support, HalfCircle):
            (y, y_error), reach = approximation(border.support.y), math.sqrt(sum(approximation(border.support.r2)))
            # An arc rises beyond its ends to one side only.
            if border.support.upper:
                highs.append(y + y_error + reach)
            else:
                lows.append(y - y_error - reach)
        slack = _MARGIN * (1.0 + max(*map(abs, lows), *map(abs, highs)))
        return cls(border, bit, min(lows) - slack, max(highs) + slack)


@dataclass(frozen=True, slots=True, eq=False)
class Event:
    """A point where something happens; just a crossing, if nothing else is said."""

    point: Point
    starts: tuple[Piece, ...] = ()
    ends: tuple[Piece, ...] = ()
    spots: tuple[tuple[Mask, bool], ...] = ()

    def __lt__(self, other: "Event") -> bool:
        return self.point < other.point

    @classmethod
    def of(cls, together: Sequence["Event"]) -> "Event":
        """Join events at one point, written in the simplest way."""
        if len(together) == 1:
            return together[0]
        # Equal points may be written with roots or without; all that follows is cheaper without.
        point = next((event.point for event in together if event.point.is_rational), together[0].point)
        starts = tuple(piece for event in together for piece in event.starts)
        ends = tuple(piece for event in together for piece in event.ends)
        return cls(point, starts, ends, tuple(spot for event in together for spot in event.spots))


def events_of(planar: PlanarSet, bit: Mask) -> Iterator[Event]:
    """Return what is known of a set before the sweep begins."""
    for border in planar.borders:
        piece = Piece.of(border, bit)
        yield Event(border.start, starts=(piece,))
        yield Event(border.end, ends=(piece,))
    for spot in planar.spots:
        yield Event(spot.point, spots=((bit, spot.on),))
