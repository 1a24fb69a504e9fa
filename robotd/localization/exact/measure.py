"""Areas and lengths of cells of an arrangement, in floats: arcs have no exact ones."""

import math

from robotd.localization.exact.arrangement import Arrangement, Edge
from robotd.localization.exact.points import Point
from robotd.localization.exact.supports import HalfCircle, Support


def face_areas(arrangement: Arrangement) -> list[float]:
    """Return the area of every face; infinite for the far one."""
    twice = [0.0] * len(arrangement.faces)
    for edge in arrangement.edges:
        swept = _twice_swept(edge, *ends_of(arrangement, edge))
        twice[edge.left] += swept
        twice[edge.right] -= swept
    return [math.inf, *(area / 2.0 for area in twice[1:])]


def edge_length(arrangement: Arrangement, edge: Edge) -> float:
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


def ends_of(arrangement: Arrangement, edge: Edge) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the ends of an edge, nearly."""
    return arrangement.vertices[edge.start].point.floats, arrangement.vertices[edge.end].point.floats


def _turn(half: HalfCircle, x: float, y: float, end_x: float, end_y: float) -> float:
    return angle_at(half, end_x, end_y) - angle_at(half, x, y)


def _twice_swept(edge: Edge, start: tuple[float, float], end: tuple[float, float]) -> float:
    """Return twice the area that a ray from the origin sweeps along an edge (Green's theorem)."""
    (x, y), (end_x, end_y) = start, end
    if not isinstance(edge.support, HalfCircle):
        return x * end_y - end_x * y
    half = edge.support
    chord = float(half.x) * (end_y - y) - float(half.y) * (end_x - x)
    return chord + float(half.r2) * _turn(half, x, y, end_x, end_y)
