"""The outlines of a set as closed polylines, for pictures and for other programs."""

from collections.abc import Iterator
from functools import cmp_to_key
from itertools import accumulate, pairwise

from robotd.exact.measure import drawn
from robotd.exact.planar import Border, PlanarSet
from robotd.exact.points import Point, compare_points

Polyline = list[tuple[float, float]]


def outline_loops(planar: PlanarSet) -> list[Polyline]:
    """Return the borders of a set's areas as closed polylines; what lies within an odd number of them belongs.

    A set that reaches to infinity is, within them, what does not.
    """
    # Borders with the set on both sides, or on neither, bound no area.
    ways = [_way(border) for border in planar.borders if border.left != border.right]
    leaving: dict[int, list[int]] = {}
    nodes = _nodes([end for start, _, _, end in ways for end in (start, end)])
    for number, (start, _, _, _) in enumerate(ways):
        leaving.setdefault(nodes[id(start)], []).append(number)
    loops = []
    while any(leaving.values()):
        node = next(node for node, numbers in leaving.items() if numbers)
        loop: Polyline = []
        while leaving.get(node):
            _, border, forward, end = ways[leaving[node].pop()]
            line = drawn(border.support, border.start, border.end)
            # Without its end, with which the next one begins.
            loop.extend((line if forward else line[::-1])[:-1])
            node = nodes[id(end)]
        loops.append(loop)
    return loops


def single_lines(planar: PlanarSet) -> list[Polyline]:
    """Return the borders that belong where nothing on either side does."""
    alone = (border for border in planar.borders if border.on and not border.left and not border.right)
    return [drawn(border.support, border.start, border.end) for border in alone]


def single_points(planar: PlanarSet) -> Iterator[tuple[float, float]]:
    """Yield the spots that belong."""
    return (spot.point.floats for spot in planar.spots if spot.on)


def _way(border: Border) -> tuple[Point, Border, bool, Point]:
    """Return a border as it is walked with the set on the left: from where, itself, whether forwards, to where."""
    if border.left:
        return border.start, border, True, border.end
    return border.end, border, False, border.start


def _nodes(points: list[Point]) -> dict[int, int]:
    """Number points by their identity, equal ones alike."""
    if not points:
        return {}
    ordered = sorted(points, key=cmp_to_key(compare_points))
    steps = (compare_points(one, other) != 0 for one, other in pairwise(ordered))
    # By identity, for points cannot be hashed: equal ones may be written differently.
    return {id(point): number for point, number in zip(ordered, accumulate(steps, initial=0), strict=True)}
