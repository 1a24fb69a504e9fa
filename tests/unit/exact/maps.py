"""Small maps for property tests: convex and not, with holes, touching, overlapping, in and out of a room."""

from hypothesis import strategies as st

from robotd.exact.beams import Beam
from robotd.exact.planar import PlanarSet
from robotd.exact.points import Point
from robotd.exact.polygons import Polygon, Ring, ring_of, solid
from robotd.exact.rationals import Arithmetic
from tests.unit.exact.arithmetics import arithmetics, rationals

SHAPES = [
    [(0, 0), (1, 0), (1, 1), (0, 1)],
    [(0, 0), (2, 0), (2, 1), (0, 1)],
    [(0, 0), (2, 0), (1, 2)],
    [(0, 0), (3, 1), (1, 3)],
    [(0, 0), (2, 0), (2, 2), (1, 1), (0, 2)],
    [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)],
    [(0, 0), (4, 3), (1, 7)],
]
FRAME = [(0, 0), (6, 0), (6, 6), (0, 6)]
HOLES = [
    [[(1, 1), (5, 1), (5, 5), (1, 5)]],
    [[(0, 0), (3, 1), (1, 3)]],
    [[(0, 3), (2, 2), (2, 4)], [(2, 2), (4, 1), (4, 3)]],
    [[(1, 1), (3, 1), (3, 3), (1, 3)], [(3, 3), (5, 3), (5, 5), (3, 5)]],
]
"""Holes of a frame: apart from it, in its corner, on its side and in each other's corners."""


@st.composite
def polygons(draw: st.DrawFn) -> Polygon:
    dx, dy = draw(st.integers(0, 5)), draw(st.integers(0, 5))
    flip, arithmetic = draw(st.booleans()), draw(arithmetics)

    def placed(shape: list[tuple[int, int]]) -> Ring:
        return ring_of([(y + dx, x + dy) if flip else (x + dx, y + dy) for x, y in shape], arithmetic)

    if draw(st.integers(0, 3)):
        return Polygon(placed(draw(st.sampled_from(SHAPES))))
    return Polygon(placed(FRAME), tuple(map(placed, draw(st.sampled_from(HOLES)))))


def inside(arithmetic: Arithmetic) -> Ring:
    return ring_of([(-1, -1), (7, -1), (7, 6), (6, 7), (-1, 7)], arithmetic)


def room(arithmetic: Arithmetic) -> Polygon:
    return Polygon(ring_of([(-2, -2), (8, -2), (8, 8), (-2, 8)], arithmetic), (inside(arithmetic),))


obstacle_lists = st.lists(polygons(), min_size=1, max_size=3)
rooms = st.one_of(st.none(), st.builds(inside, arithmetics))
solids = st.builds(lambda obstacles, around: solid(obstacles, room=around), obstacle_lists, rooms)

lengths = rationals(st.integers(-4, 4))
vectors = st.tuples(lengths, lengths).filter(any)
beams = st.builds(
    lambda vector, is_hit: Beam(vector[0], vector[1], is_hit), vectors, st.sampled_from([True, True, False])
)
radii = rationals(st.sampled_from(["0", "1/2", "1", "5/4", "3"]))


def interesting(planar: PlanarSet) -> list[Point]:
    return [border.start for border in planar.borders] + [spot.point for spot in planar.spots]
