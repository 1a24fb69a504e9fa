"""Areas and lengths of cells of an arrangement, in floats: arcs have no exact ones."""

import math

from robotd.core.rectangle import Rectangle
from robotd.exact.arrangement import Arrangement, BorderEdge
from robotd.exact.points import Point
from robotd.exact.supports import HalfCircle, Support

Place = tuple[float, float]
"""A point in floats."""


def face_areas(arrangement: Arrangement) -> list[float]:
    """Return the area of every face; infinite for the far one."""
    twice = [0.0] * len(arrangement.faces)
    corners: dict[int, Place] = {}
    for edge in arrangement.edges:
        start, end = ends_of(arrangement, edge)
        for face, sense in ((edge.left, 1.0), (edge.right, -1.0)):
            twice[face] += sense * _twice_swept(edge.support, start, end, corners.setdefault(face, start))
    # The far face comes out negative, as its border is run the other way round: it has no area.
    return [math.inf, *(area / 2.0 for area in twice[1:])]


def extent(support: Support, start: Place, end: Place) -> Rectangle:
    """Return the box around a piece of a support."""
    (x, y), (end_x, end_y) = start, end
    south, north = min(y, end_y), max(y, end_y)
    if isinstance(support, HalfCircle) and x < float(support.x) < end_x:
        middle, radius = float(support.y), math.sqrt(support.r2)
        south, north = (south, middle + radius) if support.upper else (middle - radius, north)
    return Rectangle(min(x, end_x), south, max(x, end_x), north)


def edge_length(arrangement: Arrangement, edge: BorderEdge) -> float:
    """Return the length of an edge."""
    (x, y), (end_x, end_y) = ends_of(arrangement, edge)
    if isinstance(edge.support, HalfCircle):
        return abs(_turn(edge.support, x, y, end_x, end_y)) * math.sqrt(edge.support.r2)
    return math.hypot(end_x - x, end_y - y)


def drawn(support: Support, start: Point, end: Point, *, step_rad: float = 0.1) -> list[tuple[float, float]]:
    """Return a piece of a support as a polyline, for pictures."""
    if not isinstance(support, HalfCircle):
        return [start.floats, end.floats]
    first, radius = angle_at(support, *start.floats), math.sqrt(support.r2)
    turn = _turn(support, *start.floats, *end.floats)
    steps = max(1, math.ceil(abs(turn) / step_rad))
    angles = (first + turn * number / steps for number in range(1, steps))
    x, y = float(support.x), float(support.y)
    between = [(x + radius * math.cos(angle), y + radius * math.sin(angle)) for angle in angles]
    return [start.floats, *between, end.floats]


def angle_at(half: HalfCircle, x: float, y: float) -> float:
    """Return at which angle of its circle a point of a half lies: 0 to pi on the upper, -pi to 0 on the lower one."""
    angle = math.atan2(abs(y - float(half.y)), x - float(half.x))
    return angle if half.upper else -angle


def ends_of(arrangement: Arrangement, edge: BorderEdge) -> tuple[Place, Place]:
    """Return the ends of an edge, nearly."""
    return arrangement.vertices[edge.start].point.floats, arrangement.vertices[edge.end].point.floats


def _turn(half: HalfCircle, x: float, y: float, end_x: float, end_y: float) -> float:
    return angle_at(half, end_x, end_y) - angle_at(half, x, y)


def _twice_swept(support: Support, start: Place, end: Place, origin: Place) -> float:
    """Return twice the area that a ray from an origin sweeps along an edge (Green's theorem).

    An origin nearby keeps the digits that one far away would cost.
    """
    (x, y), (end_x, end_y), (origin_x, origin_y) = start, end, origin
    if not isinstance(support, HalfCircle):
        return (x - origin_x) * (end_y - origin_y) - (end_x - origin_x) * (y - origin_y)
    chord = (float(support.x) - origin_x) * (end_y - y) - (float(support.y) - origin_y) * (end_x - x)
    return chord + float(support.r2) * _turn(support, x, y, end_x, end_y)
