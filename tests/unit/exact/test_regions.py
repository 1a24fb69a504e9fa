"""Regions are what hangs together; areas and outlines are those of the sets they come from."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.exact.arrangement import Arrangement, at_least
from robotd.exact.closed_polylines import outline_loops, single_lines, single_points
from robotd.exact.locate import contains
from robotd.exact.measure import face_areas
from robotd.exact.minkowski import grown
from robotd.exact.planar import PlanarSet, Spot, area_within, disk, segment
from robotd.exact.points import Point
from robotd.exact.polygons import Polygon, ring_of, solid
from robotd.exact.rationals import Rational, rational
from robotd.exact.regions import regions
from robotd.exact.surds import sqrt
from robotd.exact.sweep import arrange
from tests.unit.exact.arithmetics import rationals
from tests.unit.exact.maps import polygons, radii
from tests.unit.exact.shapes import flipped, planar_sets, point


def square(x: int, y: int, side: int, *, closed: bool = True) -> PlanarSet:
    corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
    return area_within([ring_of(corners)], closed=closed)


def area_of(arrangement: Arrangement) -> float:
    areas = face_areas(arrangement)
    return sum(area for area, mask in zip(areas, arrangement.faces, strict=True) if mask)


def test_the_area_of_a_disk_is_that_of_a_disk() -> None:
    assert area_of(arrange([disk(point(3, -2), sqrt(rational(5)), closed=True)])) == pytest.approx(5.0 * math.pi)


def test_areas_with_holes_are_counted_without_them() -> None:
    holed = area_within(
        [ring_of([(0, 0), (4, 0), (4, 4), (0, 4)]), ring_of([(1, 1), (1, 3), (3, 3), (3, 1)])], closed=True
    )
    assert area_of(arrange([holed])) == pytest.approx(12.0)


def test_closed_squares_that_touch_in_a_corner_are_one_region_and_open_ones_two() -> None:
    for closed, expected in ((True, 1), (False, 2)):
        sets = [square(0, 0, 1, closed=closed), square(1, 1, 1, closed=closed)]
        assert len(regions(arrange(sets), at_least(1))) == expected


def test_regions_come_best_and_largest_first_and_know_their_readings() -> None:
    lonely = PlanarSet(
        (segment(point(20, 0), point(23, 4), on=True, left=False, right=False),), (Spot(point(30, 0), on=True),)
    )
    found = regions(arrange([square(0, 0, 3), square(1, 1, 1), square(10, 0, 5), lonely]), at_least(1))
    assert [region.kind for region in found] == ["area", "area", "segment", "point"]
    assert [region.readings for region in found] == [0b11, 0b100, 0b1000, 0b1000]
    assert [region.area_m2 for region in found] == pytest.approx([9.0, 25.0, 0.0, 0.0])
    assert found[2].length_m == pytest.approx(5.0)
    assert found[0].centre_m == (1.5, 1.5)


def test_all_that_no_reading_denies_reaches_to_infinity() -> None:
    everywhere = arrange([PlanarSet(far=True)])
    (region,) = regions(everywhere, at_least(1))
    assert region.area_m2 == math.inf
    assert region.kind == "area"


def test_all_but_a_hole_reaches_to_infinity_on_every_side() -> None:
    (region,) = regions(arrange([flipped(square(2, 2, 1))]), at_least(1))
    assert region.area_m2 == math.inf
    assert region.box_m == (-math.inf, -math.inf, math.inf, math.inf)


def test_a_box_holds_the_arcs_that_bulge_beyond_their_ends() -> None:
    (whole,) = regions(arrange([disk(point(3, -2), sqrt(rational(4)), closed=True)]), at_least(1))
    assert whole.box_m == pytest.approx((1.0, -4.0, 5.0, 0.0))
    above = arrange([disk(point(0, 0), rational(5), closed=True), square(-9, 3, 18)])
    (cap,) = regions(above, lambda mask: mask == 0b11)
    assert cap.box_m == pytest.approx((-4.0, 3.0, 4.0, 5.0))
    side = arrange([disk(point(0, 0), rational(5), closed=True), square(3, -9, 18)])
    (cap,) = regions(side, lambda mask: mask == 0b11)
    assert cap.box_m == pytest.approx((3.0, -4.0, 5.0, 4.0))


@pytest.mark.parametrize(("east", "north"), [("0", "0"), ("500000.1", "5600000.1"), ("-1e15", "1e15")])
def test_a_small_area_is_an_area_wherever_it_lies(east: str, north: str) -> None:
    ring = [point(east, north).moved(rational(dx), rational(dy)) for dx, dy in ((0, 0), ("0.001", 0), (0, "0.001"))]
    (region,) = regions(arrange([area_within([ring], closed=True)]), at_least(1))
    assert region.kind == "area"


def test_areas_far_from_the_origin_are_as_large_as_near_it() -> None:
    x, y = rational("500000.1"), rational("5600000.1")
    far = [square(0, 0, 1).moved(x, y), disk(point(0, 0), rational("0.1"), closed=True).moved(x, y)]
    found = {region.readings: region.area_m2 for region in regions(arrange(far), lambda mask: mask in (1, 2))}
    assert found[0b01] == pytest.approx(1.0 - 0.0025 * math.pi, abs=1e-8)
    assert found[0b10] == pytest.approx(0.0075 * math.pi, abs=1e-8)


@settings(max_examples=20, deadline=None)
@given(polygons(), radii)
def test_a_convex_polygon_grows_by_its_edges_and_a_whole_disk(polygon: Polygon, eps: Rational) -> None:
    hull = polygon.outer[:3]  # three corners of whatever shape: a triangle
    walls = solid([Polygon(hull)])
    edges = sum(math.dist(one.floats, other.floats) for one, other in pairwise((*hull, hull[0])))
    steiner = area_of(arrange([walls])) + edges * float(eps) + math.pi * float(eps) ** 2
    assert area_of(arrange([grown(walls, eps)])) == pytest.approx(steiner)


odd = rationals(st.integers(-50, 700)).map(lambda number: 2 * number + 1)
places = st.builds(Point, odd.map(lambda number: number / 194), odd.map(lambda number: number / 178))
"""Points that are on no line and no circle of small whole numbers."""


def windings(planar: PlanarSet, x: float, y: float) -> int:
    turned = 0.0
    for loop in outline_loops(planar):
        angles = [math.atan2(at_y - y, at_x - x) for at_x, at_y in (*loop, loop[0])]
        turned += sum(math.remainder(after - before, math.tau) for before, after in pairwise(angles))
    return round(turned / math.tau)


@settings(max_examples=40, deadline=None)
@given(st.lists(planar_sets, min_size=1, max_size=4), st.integers(1, 2), st.lists(places, min_size=2, max_size=6))
def test_outlines_run_once_round_every_area(sets: list[PlanarSet], least: int, somewhere: list[Point]) -> None:
    whole = arrange(sets).select(at_least(least))
    corners = [corner for loop in outline_loops(whole) for corner in loop]
    for at in somewhere:
        if all(math.dist(corner, at.floats) > 0.3 for corner in corners):  # arcs are drawn as polylines
            assert windings(whole, *at.floats) == contains(whole, at) - whole.far
    assert len(list(single_points(whole))) == sum(spot.on for spot in whole.spots)
    assert all(len(line) >= 2 for line in single_lines(whole))
