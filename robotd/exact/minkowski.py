"""D and E of the paper, exactly: the map grown by a disk, and the poses from which a beam runs into it.

[BrownDonald2000]_ sec. 2.2.2. D is the closed map, grown and moved. E is open in the paper, because its border holds
that of D. Point by point: *a pose is in E if the body of its beam meets the interior of the map*. A beam may graze
along a wall, and pass between two obstacles that leave just a line free.

A body meets the interior where it begins in it or enters it, through an edge or through a corner. So E is the union of
the open map, and of all edges and corners of entry swept back along the body: parallelograms with one of their sides,
and segments. That is exact for polygons that are not convex as well, without cutting them up.
"""

from collections.abc import Iterator

from robotd.exact.planar import Border, PlanarSet, Spot, disk, edge_along, line_of
from robotd.exact.points import Point
from robotd.exact.polygons import interior
from robotd.exact.rationals import Rational
from robotd.exact.supports import SupportLine
from robotd.exact.surds import Number, sign, sqrt
from robotd.exact.sweep import arrange

Way = tuple[Rational, Rational]
Vector = tuple[Number, Number]


def grown(obstacles: PlanarSet, eps: Rational) -> PlanarSet:
    """Return M (+) B_eps, closed: all points within eps of the map.

    It is the map, a strip outside each edge and a disk around each corner that stands out: O((n + s) log n) for n edges
    whose strips and disks meet in s points.
    """
    # The paper's exact case: a disk without radius has no curvature to compare.
    if eps == 0:
        return obstacles
    strips = [_strip(border, eps) for border in obstacles.borders]
    # In a corner that turns inwards every point is nearer to one of its edges, whose strip holds it.
    disks = [disk(at, eps, closed=True) for at, rays in corners(obstacles) if _stands_out(rays)]
    return arrange([obstacles, *strips, *disks]).select(bool)


def blocked(obstacles: PlanarSet, beam: Way, share: Number) -> list[PlanarSet]:
    """Return parts whose union is E: all poses from which a body, its end excluded, meets the inside of the map.

    O(n log n) for n edges.

    Args:
        obstacles: the map, closed.
        beam: the whole beam.
        share: how much of the beam is body, 0 to 1; a beam without body still begins where the robot is.
    """
    parts = [interior(obstacles)]
    if sign(share) > 0:
        body = beam[0] * share, beam[1] * share
        parts.extend(_swept_edge(border, beam, body) for border in obstacles.borders if _enters(border, beam))
        parts.extend(_swept_corner(at, beam, body) for at, rays in corners(obstacles) if _opens_into(rays, beam))
    return parts


Ray = tuple[Vector, bool]
"""The direction in which a border leaves a corner, and whether what lies left of it is solid."""


def corners(obstacles: PlanarSet) -> Iterator[tuple[Point, list[Ray]]]:
    """Return all ends of borders, each once, with the borders that leave it."""
    ends = [(border.start, border.support.direction(border.start), border.left) for border in obstacles.borders]
    for border in obstacles.borders:
        dx, dy = border.support.direction(border.end)
        ends.append((border.end, (-dx, -dy), border.right))
    ends.sort(key=lambda end: end[0])
    rays: list[Ray] = []
    for number, (at, direction, solid) in enumerate(ends):
        rays.append((direction, solid))
        # Sorted by place, so all that leave one corner follow each other.
        if number + 1 == len(ends) or ends[number + 1][0] != at:
            yield at, rays
            rays = []


def _cross(one: Vector, other: Vector) -> Number:
    return one[0] * other[1] - one[1] * other[0]


def _stands_out(rays: list[Ray]) -> bool:
    """Return whether a corner can be nearer to free points than all else of the map; when in doubt, yes."""
    solid_after = next(direction for direction, solid in rays if solid)
    free_after = next(direction for direction, solid in rays if not solid)
    # When in doubt yes: a disk too many is swallowed by the sweep, one too few would lose poses.
    return len(rays) > 2 or sign(_cross(solid_after, free_after)) > 0


def _opens_into(rays: list[Ray], body: Vector) -> bool:
    """Return whether a body that starts at a corner is inside the map at once."""
    first: Ray | None = None
    for ray in rays:
        if _along(ray[0], body):
            return False
        if first is None or _comes_before(ray[0], first[0], body):
            first = ray
    return first is not None and first[1]


def _along(one: Vector, other: Vector) -> bool:
    same_line = sign(_cross(one, other)) == 0
    return same_line and sign(one[0] * other[0] + one[1] * other[1]) > 0


def _comes_before(one: Vector, other: Vector, start: Vector) -> bool:
    """Return whether turning clockwise from a start meets one direction before the other."""
    half, other_half = (1 if sign(_cross(start, way)) > 0 else 0 for way in (one, other))
    return half < other_half if half != other_half else sign(_cross(one, other)) < 0


def _enters(border: Border, body: Vector) -> bool:
    turn = sign(_cross(border.support.direction(border.start), body))
    return (turn > 0 and border.left) or (turn < 0 and border.right)


def _strip(border: Border, eps: Rational) -> PlanarSet:
    """Return the closed rectangle between an edge of the map and its parallel at a distance, on the free side."""
    line = line_of(border)
    norm = sqrt(line.a * line.a + line.b * line.b)
    away = -eps if border.left else eps
    return _parallelogram(border, (line.a * away / norm, line.b * away / norm), (line.a, line.b), closed=True)


def _swept_edge(border: Border, beam: Way, body: Vector) -> PlanarSet:
    """Return the parallelogram that an edge sweeps back along a body: open, but with the edge."""
    return _parallelogram(border, (-body[0], -body[1]), beam, closed=False)


def _parallelogram(near: Border, offset: Vector, way: Way, *, closed: bool) -> PlanarSet:
    """Return what lies between an edge and its copy at an offset, with the edge; ``way`` is along the offset."""
    # Sides run along known rational directions: drawn through computed ends, a slope could be irrational (decision 14).
    line, one, two = line_of(near), near.start, near.end
    three, four = two.moved(*offset), one.moved(*offset)
    far = SupportLine(line.a, line.b, line.c + (line.a * offset[0] + line.b * offset[1]))
    left = sign(_cross(line.direction(one), offset)) > 0
    sides = (
        edge_along(line, one, two, on=True, left=left, right=not left),
        edge_along(SupportLine.through(two, *way), two, three, on=closed, left=left, right=not left),
        edge_along(far, three, four, on=closed, left=left, right=not left),
        edge_along(SupportLine.through(one, *way), four, one, on=closed, left=left, right=not left),
    )
    return PlanarSet(sides)


def _swept_corner(at: Point, beam: Way, body: Vector) -> PlanarSet:
    """Return the segment that a corner sweeps back along a body, without its far end."""
    end = at.moved(-body[0], -body[1])
    side = edge_along(SupportLine.through(at, *beam), at, end, on=True, left=False, right=False)
    return PlanarSet((side,), (Spot(end, on=False),))
