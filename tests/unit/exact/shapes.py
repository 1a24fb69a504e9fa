"""Small sets for property tests: coordinates from a coarse lattice, so that everything meets everything."""

from hypothesis import strategies as st

from robotd.exact.planar import PlanarSet, Spot, area_within, disk, segment, twice_area
from robotd.exact.points import Point
from robotd.exact.rationals import Rational, rational
from robotd.exact.surds import sign, sqrt
from tests.unit.exact.arithmetics import rationals


def flipped(planar: PlanarSet) -> PlanarSet:
    """Return the complement of a set without spots."""
    borders = tuple(
        type(border)(border.support, border.start, border.end, not border.right, not border.on, not border.left)
        for border in planar.borders
    )
    return PlanarSet(borders, (), not planar.far)


coordinates = rationals(st.integers(0, 6))
points = st.builds(Point, coordinates, coordinates)
flags = st.booleans()


@st.composite
def triangles(draw: st.DrawFn) -> PlanarSet:
    ring = draw(st.lists(points, min_size=3, max_size=3).filter(lambda ring: sign(twice_area(ring)) != 0))
    return area_within([ring if sign(twice_area(ring)) > 0 else ring[::-1]], closed=draw(flags))


@st.composite
def rectangles(draw: st.DrawFn) -> PlanarSet:
    x0, y0 = draw(coordinates), draw(coordinates)
    x1, y1 = x0 + draw(st.integers(1, 3)), y0 + draw(st.integers(1, 3))
    ring = [Point(x0, y0), Point(x1, y0), Point(x1, y1), Point(x0, y1)]
    return area_within([ring], closed=draw(flags))


disks = st.builds(disk, points, rationals(st.integers(1, 5)).map(sqrt), closed=flags)


@st.composite
def segments(draw: st.DrawFn) -> PlanarSet:
    ends = draw(st.lists(points, min_size=2, max_size=2).filter(lambda ends: ends[0] != ends[1]))
    return PlanarSet((segment(*ends, on=True, left=False, right=False),), (Spot(ends[0], draw(flags)),))


spots = st.builds(lambda point: PlanarSet((), (Spot(point, True),)), points)
complements = st.one_of(triangles(), disks).map(flipped)
planar_sets = st.one_of(triangles(), rectangles(), disks, segments(), spots, complements)


def point(x: str | int | Rational, y: str | int | Rational) -> Point:
    return Point(rational(x), rational(y))
