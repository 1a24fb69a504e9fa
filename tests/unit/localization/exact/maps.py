"""Small maps for property tests: convex and not, with holes, touching, overlapping, in and out of a room."""

from hypothesis import strategies as st

from robotd.localization.exact.beams import Beam
from robotd.localization.exact.planar import PlanarSet
from robotd.localization.exact.points import Point
from robotd.localization.exact.polygons import Polygon, ring_of, solid
from robotd.localization.exact.rationals import rational

SHAPES = [
    [(0, 0), (1, 0), (1, 1), (0, 1)],
    [(0, 0), (2, 0), (2, 1), (0, 1)],
    [(0, 0), (2, 0), (1, 2)],
    [(0, 0), (3, 1), (1, 3)],
    [(0, 0), (2, 0), (2, 2), (1, 1), (0, 2)],
    [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)],
    [(0, 0), (4, 3), (1, 7)],
]


@st.composite
def polygons(draw: st.DrawFn) -> Polygon:
    dx, dy = draw(st.integers(0, 5)), draw(st.integers(0, 5))
    flip = draw(st.booleans())
    shape = draw(st.sampled_from(SHAPES))
    return Polygon(ring_of([(y + dx, x + dy) if flip else (x + dx, y + dy) for x, y in shape]))


INSIDE = ring_of([(-1, -1), (7, -1), (7, 6), (6, 7), (-1, 7)])
ROOM = Polygon(ring_of([(-2, -2), (8, -2), (8, 8), (-2, 8)]), (INSIDE,))
obstacle_lists = st.lists(polygons(), min_size=1, max_size=3)
solids = st.builds(lambda obstacles, room: solid(obstacles, room=room), obstacle_lists, st.sampled_from([None, INSIDE]))

lengths = st.integers(-4, 4).map(rational)
vectors = st.tuples(lengths, lengths).filter(any)
beams = st.builds(
    lambda vector, is_hit: Beam(vector[0], vector[1], is_hit), vectors, st.sampled_from([True, True, False])
)
radii = st.sampled_from(["0", "1/2", "1", "5/4", "3"]).map(rational)


def interesting(planar: PlanarSet) -> list[Point]:
    return [border.start for border in planar.borders] + [spot.point for spot in planar.spots]
