"""What is solid is what lies in one of the polygons: counted again here, with nothing but fractions."""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.exact.locate import contains
from robotd.exact.outlines import outlines
from robotd.exact.planar import PlanarSet
from robotd.exact.points import Point
from robotd.exact.polygons import Polygon, Ring, edge_count, interior, ring_of, solid
from robotd.exact.rationals import Arithmetic, rational
from robotd.exact.surds import Number, Surd
from robotd.exact.sweep import arrange
from tests.unit.exact.arithmetics import arithmetics
from tests.unit.exact.maps import polygons, rooms

Place = tuple[Fraction, Fraction]
HAIR = Fraction(1, 10**6)
"""Nearer to a point of the lattice is no edge that does not go through it."""


def fraction(number: Number) -> Fraction:
    assert not isinstance(number, Surd)
    return Fraction(int(number.numerator), int(number.denominator))


def corners(ring: Ring) -> list[Place]:
    return [(fraction(point.x), fraction(point.y)) for point in ring]


def is_in(rings: Sequence[Sequence[Place]], x: Fraction, y: Fraction) -> bool:
    """Return whether a point is on a ring, or crosses an odd number of edges on its way east."""
    odd = False
    for ring in rings:
        for (ax, ay), (bx, by) in zip(ring, [*ring[1:], ring[0]], strict=True):
            turn = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
            if turn == 0 and (ax - x) * (bx - x) + (ay - y) * (by - y) <= 0:
                return True
            if (ay > y) != (by > y):
                odd ^= (turn > 0) == (by > ay)
    return odd


halves = st.builds(lambda number: Fraction(number, 2), st.integers(-6, 26))
some_places = st.lists(st.tuples(halves, halves), max_size=8)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(polygons(), min_size=1, max_size=4), rooms, st.lists(st.tuples(halves, halves), max_size=8), arithmetics
)
def test_the_union_holds_just_the_points_of_its_polygons(
    found: list[Polygon], room: Ring | None, places: list[Place], arithmetic: Arithmetic
) -> None:
    walls = solid(found, room=room)
    shapes = [[corners(ring) for ring in (polygon.outer, *polygon.holes)] for polygon in found]

    def is_solid(x: Fraction, y: Fraction) -> bool:
        # Just outside a room is solid, and so is its border.
        beyond = room is not None and not all(
            is_in([corners(room)], x + dx, y + dy) for dx in (-HAIR, HAIR) for dy in (-HAIR, HAIR)
        )
        return beyond or any(is_in(shape, x, y) for shape in shapes)

    for x, y in [*places, *(corner for shape in shapes for ring in shape for corner in ring)]:
        at = Point(rational(x, arithmetic), rational(y, arithmetic))
        assert contains(walls, at) == is_solid(x, y)
        around = [
            is_solid(x + dx * HAIR, y + dy * HAIR)
            for dx, dy in ((-2, -9), (-9, -2), (-9, 2), (-2, 9), (2, 9), (9, 2), (9, -2), (2, -9), (9, 9), (-9, 9))
        ]
        if not all(around):
            assert not contains(interior(walls), at)


@settings(max_examples=40, deadline=None)
@given(hnp.arrays(np.bool_, st.tuples(st.integers(1, 5), st.integers(1, 5))), st.booleans())
def test_outlines_are_the_union_of_the_cells(occupied: NDArray[np.bool_], outside: bool) -> None:
    cells = [
        Polygon(ring_of([(col, row), (col + 1, row), (col + 1, row + 1), (col, row + 1)]))
        for row, col in np.argwhere(occupied).tolist()
    ]
    rows, cols = occupied.shape
    room = ring_of([(0, 0), (cols, 0), (cols, rows), (0, rows)]) if outside else None
    one: PlanarSet = outlines(occupied, rational(1), outside=outside)
    other = solid(cells, room=room)
    assert all(mask in (0b00, 0b11) for mask in arrange([one, other]).masks)
    assert edge_count(one) == edge_count(other)
