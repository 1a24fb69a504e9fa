"""Where the answer is: the connected regions of the cells of an arrangement that belong to it.

[BrownDonald2000]_ sec. 2.2.1: loc may be several separate regions, and all of them are the answer. With an error radius
they are areas; without, segments and single points.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from robotd.localization.exact.arrangement import Arrangement, Mask
from robotd.localization.exact.measure import edge_length, ends_of, face_areas


@dataclass(frozen=True, slots=True)
class Region:
    """A connected set of poses."""

    best_rank: int
    """How many readings hold in the best of its cells."""
    area_m2: float
    """Infinite if it reaches to infinity."""
    length_m: float
    """Of its edges that do not just surround or cut its areas."""
    box_m: tuple[float, float, float, float]
    """``(west, south, east, north)``."""
    readings: Mask
    """Which readings hold in the best of its cells."""

    @property
    def centre_m(self) -> tuple[float, float]:
        """The middle of its box."""
        west, south, east, north = self.box_m
        return (west + east) / 2.0, (south + north) / 2.0

    @property
    def kind(self) -> str:
        """``area``, ``segment`` or ``point``."""
        if self.area_m2 > 0.0:
            return "area"
        return "segment" if self.length_m > 0.0 else "point"


def regions(arrangement: Arrangement, belongs: Callable[[Mask], bool]) -> list[Region]:
    """Return the connected regions of all cells whose masks belong: best rank first, then largest, then from the west.

    Two cells are connected where one lies on the border of the other and both belong.
    """
    areas = face_areas(arrangement)
    found = [_region(arrangement, areas, cells) for cells in _components(arrangement, belongs)]
    return sorted(found, key=lambda region: (-region.best_rank, -region.area_m2, -region.length_m, region.box_m))


def of_rank(least: int) -> Callable[[Mask], bool]:
    """Return the condition that at least so many readings hold."""
    return lambda mask: mask.bit_count() >= least


@dataclass(frozen=True, slots=True)
class _Cells:
    """The cells of one region."""

    faces: list[int]
    edges: list[int]
    vertices: list[int]


def _components(arrangement: Arrangement, belongs: Callable[[Mask], bool]) -> Iterator[_Cells]:
    """Join what touches; cells are numbered faces first, then edges, then vertices."""
    first_edge = len(arrangement.faces)
    first_vertex = first_edge + len(arrangement.edges)
    member = [belongs(mask) for mask in arrangement.masks]
    parents = list(range(len(member)))

    def root(cell: int) -> int:
        while parents[cell] != cell:
            parents[cell] = cell = parents[parents[cell]]
        return cell

    for one, other in _touching(arrangement, first_edge, first_vertex):
        if member[one] and member[other]:
            parents[root(one)] = root(other)
    components: dict[int, _Cells] = {}
    for cell, is_member in enumerate(member):
        if is_member:
            cells = components.setdefault(root(cell), _Cells([], [], []))
            if cell < first_edge:
                cells.faces.append(cell)
            elif cell < first_vertex:
                cells.edges.append(cell - first_edge)
            else:
                cells.vertices.append(cell - first_vertex)
    yield from components.values()


def _touching(arrangement: Arrangement, first_edge: int, first_vertex: int) -> Iterator[tuple[int, int]]:
    """Return all pairs of a cell and one on its border."""
    for number, edge in enumerate(arrangement.edges, first_edge):
        for face in (edge.left, edge.right):
            yield face, number
            yield face, first_vertex + edge.start
            yield face, first_vertex + edge.end
        yield number, first_vertex + edge.start
        yield number, first_vertex + edge.end
    for number, vertex in enumerate(arrangement.vertices, first_vertex):
        yield vertex.face, number


def _region(arrangement: Arrangement, areas: list[float], cells: _Cells) -> Region:
    faces = set(cells.faces)
    edges = [arrangement.edges[number] for number in cells.edges]
    lines = [edge for edge in edges if edge.left not in faces and edge.right not in faces]
    masks = [arrangement.faces[face] for face in cells.faces] + [edge.mask for edge in edges]
    masks += [arrangement.vertices[number].mask for number in cells.vertices]
    best = max(masks, key=int.bit_count)
    return Region(
        best.bit_count(),
        sum(areas[face] for face in cells.faces),
        sum(edge_length(arrangement, edge) for edge in lines),
        _box(arrangement, cells),
        best,
    )


def _box(arrangement: Arrangement, cells: _Cells) -> tuple[float, float, float, float]:
    faces = set(cells.faces)
    ends = [arrangement.vertices[number].point.floats for number in cells.vertices]
    ends += [end for number in cells.edges for end in ends_of(arrangement, arrangement.edges[number])]
    around = (edge for edge in arrangement.edges if edge.left in faces or edge.right in faces)
    ends += [end for edge in around for end in ends_of(arrangement, edge)]
    xs, ys = [x for x, _ in ends], [y for _, y in ends]
    return (
        min(xs, default=-math.inf),
        min(ys, default=-math.inf),
        max(xs, default=math.inf),
        max(ys, default=math.inf),
    )
