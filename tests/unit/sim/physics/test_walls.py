import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from robotd.sim.physics.walls import NO_WALLS, Plate, Point, WallSegments, clearance_m, nearest_points, ray_cast

COORDINATE = st.integers(-8, 8).map(float)
POINT = st.tuples(COORDINATE, COORDINATE)
SEGMENTS = st.lists(st.tuples(POINT, POINT).filter(lambda pair: pair[0] != pair[1]), min_size=1, max_size=8)
CORNERS = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))
SQUARE = WallSegments.of((start, end, math.inf) for start, end in zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True))


def slow_ray_cast(segments: list[tuple[Point, Point]], origin: Point, towards: Point) -> float:
    """The same with exact fractions, wall by wall, along the ray through a point with whole coordinates."""
    ox, oy = map(Fraction, origin)
    dx, dy = Fraction(towards[0]) - ox, Fraction(towards[1]) - oy
    best: Fraction | None = None
    for start, end in segments:
        sx, sy = Fraction(start[0]) - ox, Fraction(start[1]) - oy
        ex, ey = Fraction(end[0]) - Fraction(start[0]), Fraction(end[1]) - Fraction(start[1])
        cross = dx * ey - dy * ex
        if cross == 0:
            ends = [(x * dx + y * dy) / (dx * dx + dy * dy) for x, y in ((sx, sy), (sx + ex, sy + ey))]
            met = max(Fraction(0), min(ends)) if sx * ey == sy * ex and max(ends) >= 0 else None
        else:
            along, share = (sx * ey - sy * ex) / cross, (sx * dy - sy * dx) / cross
            met = along if along >= 0 and 0 <= share <= 1 else None
        if met is not None and (best is None or met < best):
            best = met
    return math.inf if best is None else float(best) * math.hypot(dx, dy)


def walls_of(segments: list[tuple[Point, Point]]) -> WallSegments:
    return WallSegments.of((start, end, math.inf) for start, end in segments)


@settings(max_examples=150)
@given(SEGMENTS, POINT, st.tuples(st.integers(-300, 300), st.integers(-300, 300)))
def test_a_ray_ends_where_exact_arithmetic_says(
    segments: list[tuple[Point, Point]], origin: Point, aim: tuple[int, int]
) -> None:
    towards = (origin[0] + aim[0] / 37 + 0.001, origin[1] + aim[1] / 41 + 0.0007)  # no corner lies exactly there
    direction = math.atan2(towards[1] - origin[1], towards[0] - origin[0])
    expected = slow_ray_cast(segments, origin, towards)
    assert ray_cast(walls_of(segments), origin, direction) == pytest.approx(expected, abs=1e-9)


@settings(max_examples=60)
@given(SEGMENTS, POINT, st.sampled_from([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)]))
def test_a_ray_along_an_axis_meets_corners_and_walls_edge_on(
    segments: list[tuple[Point, Point]], origin: Point, axis: Point
) -> None:
    towards = (origin[0] + axis[0], origin[1] + axis[1])
    found = ray_cast(walls_of(segments), origin, math.atan2(axis[1], axis[0]))
    assume(axis == (1.0, 0.0) or _is_robust(segments, origin, axis))
    assert found == pytest.approx(slow_ray_cast(segments, origin, towards), abs=1e-9)


def _is_robust(segments: list[tuple[Point, Point]], origin: Point, axis: Point) -> bool:
    """Whether no end of a wall lies in the ray's line: sin(pi) is not zero, so such ends may be missed."""
    return all((p[0] - origin[0]) * axis[1] != (p[1] - origin[1]) * axis[0] for pair in segments for p in pair)


def test_no_ray_slips_through_a_corner() -> None:
    for corner in CORNERS:
        for origin in ((1.0, 1.3), (2.7, 0.4), (math.pi, math.e)):
            direction = math.atan2(corner[1] - origin[1], corner[0] - origin[0])
            assert ray_cast(SQUARE, origin, direction) == pytest.approx(math.dist(origin, corner))


def test_where_no_wall_is_the_ray_never_ends() -> None:
    assert ray_cast(NO_WALLS, (0.0, 0.0), 1.0) == math.inf
    assert clearance_m(NO_WALLS, (0.0, 0.0)) == math.inf


def test_a_rising_beam_passes_over_a_low_wall_and_a_falling_one_meets_it() -> None:
    walls = WallSegments.of([((2.0, -1.0), (2.0, 1.0), 0.7), ((3.0, -1.0), (3.0, 1.0), math.inf)])
    assert ray_cast(walls, (0.0, 0.0), 0.0, eye_height_m=0.5, climb=0.2) == pytest.approx(3.0)
    assert ray_cast(walls, (0.0, 0.0), 0.0, eye_height_m=0.5, climb=0.05) == pytest.approx(2.0)
    assert ray_cast(walls, (0.0, 0.0), 0.0, eye_height_m=0.9, climb=-0.2) == pytest.approx(2.0)


def test_walls_of_no_length_are_left_out() -> None:
    assert WallSegments.of([((1.0, 1.0), (1.0, 1.0), math.inf)]).starts_m.shape == (0, 2)


@settings(max_examples=50)
@given(SEGMENTS, POINT)
def test_the_nearest_point_is_nearer_than_any_sample_of_the_wall(
    segments: list[tuple[Point, Point]], point: Point
) -> None:
    distances, offsets = nearest_points(walls_of(segments), point)
    for (start, end), distance, offset in zip(segments, distances, offsets, strict=True):
        samples = np.array(start) + np.linspace(0.0, 1.0, 201)[:, None] * (np.array(end) - np.array(start))
        to_samples = np.hypot(*(samples - np.array(point)).T)
        assert distance <= to_samples.min() + 1e-9
        assert distance == pytest.approx(to_samples.min(), abs=0.13)
        assert math.hypot(*offset) == pytest.approx(distance)


TABLE = ((1.0, -1.0), (3.0, -1.0), (3.0, 1.0), (1.0, 1.0))


def top(from_m: float, height_m: float) -> WallSegments:
    """Return what a table's top is: its sides, and its two faces."""
    sides = [(start, end, height_m, from_m) for start, end in zip(TABLE, TABLE[1:] + TABLE[:1], strict=True)]
    return WallSegments.of(sides, Plate(TABLE, from_m), Plate(TABLE, height_m))


def slow_table(from_m: float, height_m: float, eye_m: float, climb: float, direction: float) -> float:
    """Go along a beam in small steps until it is within the top."""
    way_m = np.arange(0.0, 8.0, 0.0005)
    x_m, y_m, z_m = way_m * math.cos(direction), way_m * math.sin(direction), eye_m + climb * way_m
    within = (abs(x_m - 2.0) <= 1.0) & (abs(y_m) <= 1.0) & (z_m >= from_m) & (z_m <= height_m)
    return float(way_m[within.argmax()]) if within.any() else math.inf


@settings(max_examples=60)
@given(st.floats(0.2, 1.2), st.floats(-0.5, 0.5), st.floats(-0.7, 0.7))
@example(1.0, 0.5, 2.225073858507203e-309)  # so nearly along an edge that its crossing is farther than any number
def test_a_beam_meets_a_tables_top_at_its_edge_from_below_or_from_above(eye: float, climb: float, aim: float) -> None:
    assume(abs(climb) > 0.01)
    found = ray_cast(top(0.70, 0.74), (0.0, 0.0), aim, eye_height_m=eye, climb=climb)
    slow = slow_table(0.70, 0.74, eye, climb, aim)
    # Where it just passes a corner or an edge, steps may miss what is thinner than they are.
    assert found == pytest.approx(slow, abs=0.002) or _grazes(eye, climb, aim)


def _grazes(eye: float, climb: float, aim: float) -> bool:
    around = {
        math.isinf(slow_table(0.70, 0.74, eye + up, climb, aim + turned_rad))
        for up in (-0.002, 0.002)
        for turned_rad in (-0.002, 0.002)
    }
    return len(around) == 2


def test_a_level_beam_passes_under_a_table_and_over_a_crate() -> None:
    assert ray_cast(top(0.70, 0.74), (0.0, 0.0), 0.0, eye_height_m=0.55) == math.inf
    assert ray_cast(top(0.0, 0.4), (0.0, 0.0), 0.0, eye_height_m=0.55) == math.inf
    assert ray_cast(top(0.70, 0.74), (0.0, 0.0), 0.0, eye_height_m=0.55, climb=0.1) == pytest.approx(1.5)
    assert ray_cast(top(0.0, 0.4), (0.0, 0.0), 0.0, eye_height_m=0.55, climb=-0.1) == pytest.approx(1.5)
