"""Theorem 3: without an error radius only borders of D outlive the open E, as segments and as isolated points."""

import pytest

from robotd.exact.beams import Beam
from robotd.exact.casting import CastOutcome, cast
from robotd.exact.feasible import PolygonMap, best_rank, feasible_poses, of_rank, ranked
from robotd.exact.locate import contains
from robotd.exact.measure import face_areas
from robotd.exact.points import Point
from robotd.exact.polygons import Polygon, Ring, ring_of, solid
from robotd.exact.rationals import ARITHMETICS, DEFAULT, Arithmetic, rational
from robotd.exact.sweep import arrange

every_arithmetic = pytest.mark.parametrize("arithmetic", ARITHMETICS.values(), ids=ARITHMETICS)


def box(x: int, y: int, width: int, height: int, arithmetic: Arithmetic = DEFAULT) -> Ring:
    return ring_of([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], arithmetic)


@every_arithmetic
def test_one_reading_leaves_a_segment_on_each_wall_that_faces_it(arithmetic: Arithmetic) -> None:
    walls = solid([Polygon(box(4, 0, 2, 3, arithmetic))])
    east = Beam(rational(2, arithmetic), rational(0, arithmetic))
    feasible = feasible_poses(PolygonMap(walls, rational(0, arithmetic)), east)
    # The west wall, seen from 2 m west of it; along the lower and the upper wall the beam grazes, to end on them.
    assert not any(face for face in arrange([feasible]).faces)
    ends = sorted((border.start.floats, border.end.floats) for border in feasible.borders)
    assert ends == [((2.0, 0.0), (2.0, 3.0)), ((2.0, 0.0), (4.0, 0.0)), ((2.0, 3.0), (4.0, 3.0))]


@every_arithmetic
def test_a_gap_of_no_width_leaves_an_isolated_point(arithmetic: Arithmetic) -> None:
    # Two triangles touch with their tips. Just one beam gets through, to the wall behind them.
    below, above = (Polygon(ring_of([(0, 0), (-4, y), (4, y)], arithmetic)) for y in (-4, 4))
    beam = Beam(rational(3, arithmetic), rational(0, arithmetic))
    walls = solid([below, above, Polygon(box(2, -1, 1, 2, arithmetic))])
    polygon_map = PolygonMap(walls, rational(0, arithmetic))
    only = Point(rational(-1, arithmetic), rational(0, arithmetic))
    feasible = feasible_poses(polygon_map, beam)
    assert contains(feasible, only)
    assert [spot.point.floats for spot in feasible.spots if spot.on] == [(-1.0, 0.0)]
    assert not any(border.start <= only <= border.end and border.support.side(only) == 0 for border in feasible.borders)
    for dx, dy in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (-1, -1)):
        beside = only.moved(rational(dx, arithmetic) / 100, rational(dy, arithmetic) / 100)
        assert cast(walls, beam, rational(0, arithmetic), beside).outcome is not CastOutcome.HOLDS
        assert not contains(feasible, beside)
    with_radius = feasible_poses(PolygonMap(walls, rational("1/10", arithmetic)), beam)
    assert max(face_areas(arrange([with_radius]))[1:]) > 0.0, "with an error radius it is an area"


def test_segments_that_cross_leave_a_point_for_both_readings() -> None:
    walls = solid([], room=box(0, 0, 8, 6))
    readings = [Beam(rational(3), rational(0)), Beam(rational(0), rational(-2))]
    arrangement = ranked(PolygonMap(walls, rational(0)), readings)
    assert best_rank(arrangement) == 2
    whole = of_rank(arrangement, 2)
    assert not whole.borders
    # In the upper left corner both beams graze along a wall, and end on it.
    assert [spot.point.floats for spot in whole.spots] == [(0.0, 6.0), (5.0, 2.0)]


@pytest.mark.parametrize("reach", [3, 5, 7])
def test_an_over_range_reading_leaves_all_that_its_body_does_not_forbid(reach: int) -> None:
    walls = solid([Polygon(box(4, 0, 2, 3))], room=box(0, 0, 10, 3))
    miss = Beam(rational(reach), rational(0), is_hit=False)
    feasible = feasible_poses(PolygonMap(walls, rational(0)), miss)
    areas = face_areas(arrange([feasible]))
    # West of the block 4 m are free, and so are 4 m east of it.
    inside = sum(area for area, mask in zip(areas, arrange([feasible]).faces, strict=True) if mask)
    assert inside == pytest.approx(2 * 3.0 * max(0, 4 - reach))
    assert contains(feasible, Point(rational(4 - reach), rational(1))) == (reach <= 4)
    # Along the lower wall a beam grazes, but between wall and block there is no gap.
    assert contains(feasible, Point(rational(1), rational(0))) == (reach == 3)


def test_tangents_hold_just_as_far_as_eps_reaches() -> None:
    # The end passes a corner at exactly eps: on the arc of D there is one pose, above it none.
    walls = solid([Polygon(box(0, 0, 1, 1))])
    eps = rational(1)
    beam = Beam(rational(0), rational(-3))
    feasible = feasible_poses(PolygonMap(walls, eps), beam)
    for x, y, holds in (("8/5", "24/5", True), ("81/50", "24/5", False), ("-1", "4", True), ("-1001/1000", "4", False)):
        at = Point(rational(x), rational(y))
        assert contains(feasible, at) == holds
        assert (cast(walls, beam, eps, at).outcome is CastOutcome.HOLDS) == holds
