"""What must not matter does not matter, and what must grow grows."""

from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.exact.beams import Beam
from robotd.exact.casting import CastOutcome, cast, distance_square, rank_at
from robotd.exact.error_bracket import smallest_error
from robotd.exact.feasible import PolygonMap, best_rank, feasible_poses, of_rank, ranked
from robotd.exact.locate import contains
from robotd.exact.minkowski import grown
from robotd.exact.planar import PlanarSet
from robotd.exact.points import Point
from robotd.exact.polygons import Polygon, Ring, edge_count, ring_of, solid
from robotd.exact.rationals import DEFAULT, Arithmetic, Rational, rational
from robotd.exact.regions import regions
from robotd.exact.surds import Number, Surd, arithmetic_of
from robotd.exact.sweep import arrange
from tests.unit.exact.arithmetics import arithmetics, rationals
from tests.unit.exact.maps import beams, inside, interesting, obstacle_lists, radii, room, solids

Linear = Callable[[Number, Number], tuple[Number, Number]]


def rotated(x: Number, y: Number) -> tuple[Number, Number]:
    return (x * 5 - y * 12) / 13, (x * 12 + y * 5) / 13


def halved(x: Number, y: Number) -> tuple[Number, Number]:
    return x / 2, y / 2


def sheared(x: Number, y: Number) -> tuple[Number, Number]:
    return x + y * 3 / 7, y - x / 5


def moved_polygon(polygon: Polygon, linear: Linear) -> Polygon:
    rings = [tuple(Point(*linear(at.x, at.y)) for at in ring) for ring in (polygon.outer, *polygon.holes)]
    return Polygon(rings[0], tuple(rings[1:]))


def moved_beam(beam: Beam, linear: Linear) -> Beam:
    dx, dy = linear(beam.dx, beam.dy)
    assert not isinstance(dx, Surd)
    assert not isinstance(dy, Surd)
    return Beam(dx, dy, beam.is_hit)


@pytest.mark.parametrize(
    ("linear", "scale", "errors"), [(rotated, "1", ["0", "1"]), (halved, "1/2", ["0", "1"]), (sheared, "1", ["0"])]
)
@settings(max_examples=12, deadline=None)
@given(polygons=obstacle_lists, beam=beams, arithmetic=arithmetics, data=st.data())
def test_the_choice_of_axes_does_not_matter(
    linear: Linear,
    scale: str,
    errors: list[str],
    polygons: list[Polygon],
    beam: Beam,
    arithmetic: Arithmetic,
    data: st.DataObject,
) -> None:
    eps = rational(data.draw(st.sampled_from(errors)), arithmetic)
    all_of_them = [*polygons, room(arithmetic)]
    here = feasible_poses(PolygonMap(solid(all_of_them), eps), beam)
    walls = solid([moved_polygon(polygon, linear) for polygon in all_of_them])
    there = feasible_poses(PolygonMap(walls, eps * rational(scale, arithmetic)), moved_beam(beam, linear))
    for point in interesting(here):
        assert contains(there, Point(*linear(point.x, point.y))) == contains(here, point)
    if eps == 0:
        assert len(there.borders) == len(here.borders)
        assert len(there.spots) == len(here.spots)


def with_split_edges(polygon: Polygon) -> Polygon:
    return Polygon(split(polygon.outer), tuple(map(split, polygon.holes)))


def split(ring: Ring) -> Ring:
    halves = [
        Point((one.x + other.x) / 2, (one.y + other.y) / 2)
        for one, other in zip(ring, (*ring[1:], ring[0]), strict=True)
    ]
    return tuple(point for pair in zip(ring, halves, strict=True) for point in pair)


@settings(max_examples=25, deadline=None)
@given(obstacle_lists, beams, radii)
def test_neither_order_nor_splitting_of_edges_matters(polygons: list[Polygon], beam: Beam, eps: Rational) -> None:
    one = feasible_poses(PolygonMap(solid(polygons), eps), beam)
    other = feasible_poses(PolygonMap(solid(map(with_split_edges, reversed(polygons))), eps), beam)
    assert all(mask in (0, 0b11) for mask in arrange([one, other]).masks)


@settings(max_examples=20, deadline=None)
@given(solids, beams, st.lists(radii, min_size=2, max_size=2).map(sorted))
def test_feasible_poses_grow_with_the_error_radius(obstacles: PlanarSet, beam: Beam, errors: list[Rational]) -> None:
    small, large = (feasible_poses(PolygonMap(obstacles, eps), beam) for eps in errors)
    assert 0b01 not in set(arrange([small, large]).masks)


@settings(max_examples=12, deadline=None)
@given(solids, st.lists(beams, min_size=1, max_size=4), radii, st.data())
def test_the_rank_is_the_sum_of_single_answers(
    obstacles: PlanarSet, readings: list[Beam], eps: Rational, data: st.DataObject
) -> None:
    arrangement = ranked(PolygonMap(obstacles, eps), readings)
    for vertex in data.draw(st.lists(st.sampled_from(arrangement.vertices or [None]), max_size=8)):
        if vertex is not None:
            holding = [cast(obstacles, beam, eps, vertex.point).outcome is CastOutcome.HOLDS for beam in readings]
            assert vertex.mask == sum(holds << number for number, holds in enumerate(holding))
            assert rank_at(obstacles, readings, eps, vertex.point) == sum(holding)


quarters = rationals(st.integers(-10, 40)).map(lambda number: number / 4)


@settings(max_examples=25, deadline=None)
@given(solids, radii, st.lists(st.builds(Point, quarters, quarters), min_size=4, max_size=12))
def test_the_grown_map_is_what_is_near_it(obstacles: PlanarSet, eps: Rational, places: list[Point]) -> None:
    whole = grown(obstacles, eps)
    for at in places:
        assert contains(whole, at) == (distance_square(obstacles, at) <= eps * eps)


SQUARE = ring_of([(0, 0), (4, 0), (4, 4), (0, 4)])


def test_polygons_that_share_an_edge_are_one() -> None:
    east = ring_of([(4, 1), (6, 1), (6, 3), (4, 3)])
    obstacles = solid([Polygon(SQUARE), Polygon(east)])
    assert edge_count(obstacles) == 8
    along_the_seam = Beam(rational(0), rational(6))
    verdict = cast(obstacles, along_the_seam, rational(0), Point(rational(4), rational(-1)))
    assert verdict.outcome is CastOutcome.BLOCKED
    assert verdict.free_length == 2


def test_a_ring_that_crosses_itself_is_refused() -> None:
    with pytest.raises(ValueError, match="do not close"):
        solid([Polygon(ring_of([(0, 0), (4, 4), (4, 0), (0, 3)]))])


def test_in_a_corner_two_exact_readings_leave_one_point() -> None:
    walls = solid([], room=inside(DEFAULT))
    readings = [Beam(rational(-2), rational(0)), Beam(rational(0), rational(-3)), Beam(rational(6), rational(0))]
    arrangement = ranked(PolygonMap(walls, rational(0)), readings)
    assert best_rank(arrangement) == 3
    (place,) = regions(arrangement, lambda mask: mask == 0b111)
    assert place.kind == "point"
    assert place.centre_m == (1.0, 2.0)
    assert [spot.point.floats for spot in of_rank(arrangement, 3).spots] == [(1.0, 2.0)]


def test_the_smallest_error_is_bracketed() -> None:
    walls = solid([], room=inside(DEFAULT))
    # The room is 8 m wide, and the readings to the east and the west sum to 7.2 m.
    readings = [Beam(rational(5), rational(0)), Beam(rational("-2.2"), rational(0)), Beam(rational(0), rational(-3))]
    bracket = smallest_error(walls, [readings], share=rational(1), largest=rational(2), width=rational("1/32"))
    assert bracket is not None
    assert bracket.low < rational("2/5") <= bracket.high
    assert bracket.high - bracket.low <= rational("1/32")
    two_of_them = smallest_error(walls, [readings], share=rational("2/3"), largest=rational(2), width=rational("1/32"))
    assert two_of_them is not None
    assert two_of_them.low == two_of_them.high == 0


@settings(max_examples=6, deadline=None)
@given(solids, st.lists(beams, min_size=2, max_size=4), st.integers(1, 4), arithmetics)
def test_both_ends_of_a_bracket_are_decided(
    obstacles: PlanarSet, readings: list[Beam], quarters: int, arithmetic: Arithmetic
) -> None:
    share, width = rational(quarters, arithmetic) / 4, rational("1/4", arithmetic)
    turned = [beam.turned(0.5) for beam in readings]
    asked = (readings, turned)
    bracket = smallest_error(obstacles, asked, share=share, largest=rational(4, arithmetic), width=width)

    def best(eps: Rational) -> list[int]:
        return [best_rank(ranked(PolygonMap(obstacles, eps), beams)) for beams in asked]

    needed = share * len(readings)
    if bracket is None:
        assert max(best(rational(4, arithmetic))) < needed
        return
    assert needed <= bracket.needed < needed + 1
    assert [number for number, rank in enumerate(best(bracket.high)) if rank >= needed] == list(bracket.slices)
    if bracket.low != bracket.high:
        assert bracket.high - bracket.low <= width
        assert max(best(bracket.low)) < needed


def test_where_even_the_largest_error_is_too_small_there_is_no_bracket() -> None:
    beyond = [Beam(rational(60), rational(60))]
    assert (
        smallest_error(
            solid([], room=inside(DEFAULT)), [beyond], share=rational(1), largest=rational(1), width=rational(1)
        )
        is None
    )


@pytest.mark.parametrize(("share", "width"), [("0", "1"), ("2", "1"), ("1", "0")])
def test_an_impossible_search_is_refused(share: str, width: str) -> None:
    with pytest.raises(ValueError, match="cannot look for"):
        smallest_error(
            solid([], room=inside(DEFAULT)),
            [[Beam(rational(1), rational(0))]],
            share=rational(share),
            largest=rational(1),
            width=rational(width),
        )


@settings(max_examples=10, deadline=None)
@given(solids, st.lists(beams, min_size=1, max_size=2), radii, arithmetics)
def test_an_answer_is_of_the_arithmetic_that_was_asked_in(
    obstacles: PlanarSet, readings: list[Beam], eps: Rational, arithmetic: Arithmetic
) -> None:
    arrangement = ranked(PolygonMap(obstacles, eps), readings)
    numbers = [number for vertex in arrangement.vertices for number in (vertex.point.x, vertex.point.y)]
    assert all(arithmetic_of(number) is arithmetic for number in numbers)
