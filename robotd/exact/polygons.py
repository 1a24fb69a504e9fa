"""Maps as sets of polygons: what is solid, as one closed set whatever the polygons do to each other."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from robotd.exact.planar import Border, PlanarSet, area_within, twice_area
from robotd.exact.points import Point
from robotd.exact.rationals import DEFAULT, Arithmetic, rational
from robotd.exact.surds import sign
from robotd.exact.sweep import arrange

Ring = tuple[Point, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Polygon:
    """A solid obstacle, perhaps with holes; its rings may run either way round."""

    outer: Ring
    holes: tuple[Ring, ...] = ()

    def __post_init__(self) -> None:
        """Refuse what has no area."""
        for ring in (self.outer, *self.holes):
            if len(ring) < 3 or sign(twice_area(ring)) == 0:
                raise ValueError(f"a ring needs an area, and one of {len(ring)} corners has none")


def ring_of(corners: Iterable[Sequence[int | str | float]], arithmetic: Arithmetic = DEFAULT) -> Ring:
    """Return a ring of ``(x, y)`` pairs; neither a corner said twice running nor the first said again at the end stays.

    Raises:
        ValueError: a corner has no two coordinates, or one is not a finite number.
    """
    points = [_corner(corner, arithmetic) for corner in corners]
    return tuple(point for number, point in enumerate(points) if point != points[number - 1])


def _corner(numbers: Sequence[int | str | float], arithmetic: Arithmetic) -> Point:
    if isinstance(numbers, str) or len(numbers) != 2:
        raise ValueError(f"a corner needs x and y, got {numbers}")
    return Point(rational(numbers[0], arithmetic), rational(numbers[1], arithmetic))


def turned(ring: Ring, *, counter_clockwise: bool) -> Ring:
    """Return a ring that runs as it should."""
    return ring if (sign(twice_area(ring)) > 0) == counter_clockwise else ring[::-1]


def solid(polygons: Iterable[Polygon], *, room: Ring | None = None) -> PlanarSet:
    """Return the union of polygons, closed: M; and of all that lies outside a room, if there is one.

    Shared edges are no cracks, overlaps no borders. Two polygons that touch in a point leave one there.

    Raises:
        ValueError: a ring crosses or overlaps itself or another of its polygon.
    """
    sets = [_closed(polygon) for polygon in polygons]
    if room is not None:
        outside = area_within([turned(room, counter_clockwise=False)], closed=True)
        # The room turned inside out: all beyond its outline is solid, without end.
        sets.append(PlanarSet(outside.borders, far=True))
    try:
        return arrange(sets).select(bool)
    except ValueError as error:
        raise ValueError(f"{error}: a ring crosses or overlaps itself or another of its polygon") from error


def edge_count(obstacles: PlanarSet) -> int:
    """Return n, the number of edges of a map."""
    return len(obstacles.borders)


def interior(closed: PlanarSet) -> PlanarSet:
    """Return a closed set of areas without its borders."""
    return PlanarSet(tuple(_with_on(border, on=False) for border in closed.borders), (), closed.far)


def _with_on(border: Border, *, on: bool) -> Border:
    return Border(border.support, border.start, border.end, border.right, on, border.left)


def _closed(polygon: Polygon) -> PlanarSet:
    outer = turned(polygon.outer, counter_clockwise=True)
    return area_within([outer, *(turned(hole, counter_clockwise=False) for hole in polygon.holes)], closed=True)
