"""A pose is feasible exactly if casting the beam from it says so: within areas, on edges, at corners."""

from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.exact.arrangement import Arrangement
from robotd.exact.beams import Beam
from robotd.exact.casting import CastOutcome, cast
from robotd.exact.feasible import PolygonMap, feasible_arrangement, is_feasible
from robotd.exact.locate import contains, middle
from robotd.exact.planar import Border, PlanarSet
from robotd.exact.points import Point
from robotd.exact.rationals import Rational
from tests.unit.exact.arithmetics import rationals
from tests.unit.exact.maps import beams, radii, solids


def somewhere_on(arrangement: Arrangement, edge: int) -> Point:
    of = arrangement.edges[edge]
    start, end = arrangement.vertices[of.start].point, arrangement.vertices[of.end].point
    return middle(Border(of.support, start, end, right=False, on=True, left=False))


@settings(max_examples=60, deadline=None)
@given(solids, beams, radii, st.data())
def test_every_cell_is_what_casting_the_beam_says(
    obstacles: PlanarSet, beam: Beam, eps: Rational, data: st.DataObject
) -> None:
    arrangement = feasible_arrangement(PolygonMap(obstacles, eps), beam)
    for vertex in data.draw(st.lists(st.sampled_from(arrangement.vertices), max_size=12)):
        expected = cast(obstacles, beam, eps, vertex.point).outcome is CastOutcome.HOLDS
        assert is_feasible(vertex.mask) == expected, vertex.point
    for edge in data.draw(st.lists(st.integers(0, len(arrangement.edges) - 1), max_size=6)):
        at = somewhere_on(arrangement, edge)
        expected = cast(obstacles, beam, eps, at).outcome is CastOutcome.HOLDS
        assert is_feasible(arrangement.edges[edge].mask) == expected, at


halves = rationals(st.integers(-8, 16)).map(lambda number: number / 2)


@settings(max_examples=30, deadline=None)
@given(solids, beams, radii, st.lists(st.builds(Point, halves, halves), min_size=3, max_size=10))
def test_every_point_is_what_casting_the_beam_says(
    obstacles: PlanarSet, beam: Beam, eps: Rational, probes: list[Point]
) -> None:
    feasible = feasible_arrangement(PolygonMap(obstacles, eps), beam).select(is_feasible)
    for at in probes:
        assert contains(feasible, at) == (cast(obstacles, beam, eps, at).outcome is CastOutcome.HOLDS)
