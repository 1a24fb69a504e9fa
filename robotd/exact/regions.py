"""Where the answer is: the connected regions of the cells of an arrangement that belong to it.

[BrownDonald2000]_ sec. 2.2.1: loc may be several separate regions, and all of them are the answer. With an error radius
they are areas; without, segments and single points.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from robotd.core.rectangle import Rectangle
from robotd.exact.arrangement import Arrangement, Mask
from robotd.exact.measure import edge_length, ends_of, extent, face_areas


@dataclass(frozen=True, slots=True)
class ExactRegion:
    """A connected set of poses."""

    best_rank: int
    """How many readings hold in the best of its cells."""
    kind: Literal["area", "segment", "point"]
    """What its largest cells are."""
    area_m2: float
    """Infinite if it reaches to infinity."""
    length_m: float
    """Of its edges that do not just surround or cut its areas."""
    box_m: Rectangle
    """Infinite if it reaches to infinity."""
    readings: Mask
    """Which readings hold in the best of its cells."""

    @property
    def centre_m(self) -> tuple[float, float]:
        """The middle of its box."""
        west, south, east, north = self.box_m
        return (west + east) / 2.0, (south + north) / 2.0


def regions(arrangement: Arrangement, belongs: Callable[[Mask], bool]) -> list[ExactRegion]:
    """Return the connected regions of all cells whose masks belong: best rank first, then largest, then from the west.

    Two cells are connected where one lies on the border of the other and both belong. Time is nearly linear in the
    number of cells.
    """
    areas, around = face_areas(arrangement), _borders_of_faces(arrangement)
    found = [_region(arrangement, areas, around, cells) for cells in _components(arrangement, belongs)]
    # Down to the box, so that no order depends on how cells happen to be numbered.
    return sorted(found, key=lambda region: (-region.best_rank, -region.area_m2, -region.length_m, region.box_m))


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
    # A spot in the open has no edges that would join it to the face around it.
    for number, vertex in enumerate(arrangement.vertices, first_vertex):
        yield vertex.face, number


def _borders_of_faces(arrangement: Arrangement) -> list[list[int]]:
    """Return the edges on the border of every face."""
    around: list[list[int]] = [[] for _ in arrangement.faces]
    for number, edge in enumerate(arrangement.edges):
        around[edge.left].append(number)
        around[edge.right].append(number)
    return around


def _region(arrangement: Arrangement, areas: list[float], around: list[list[int]], cells: _Cells) -> ExactRegion:
    faces = set(cells.faces)
    edges = [arrangement.edges[number] for number in cells.edges]
    lines = [edge for edge in edges if edge.left not in faces and edge.right not in faces]
    masks = [arrangement.faces[face] for face in cells.faces] + [edge.mask for edge in edges]
    masks += [arrangement.vertices[number].mask for number in cells.vertices]
    best = max(masks, key=int.bit_count)
    return ExactRegion(
        best.bit_count(),
        "area" if faces else "segment" if lines else "point",
        sum(areas[face] for face in cells.faces),
        sum(edge_length(arrangement, edge) for edge in lines),
        _box(arrangement, around, cells),
        best,
    )


def _box(arrangement: Arrangement, around: list[list[int]], cells: _Cells) -> Rectangle:
    if 0 in cells.faces:
        return Rectangle(-math.inf, -math.inf, math.inf, math.inf)
    numbers = {*cells.edges, *(number for face in cells.faces for number in around[face])}
    edges = (arrangement.edges[number] for number in numbers)
    boxes: list[tuple[float, ...]] = [extent(edge.support, *ends_of(arrangement, edge)) for edge in edges]
    boxes += [arrangement.vertices[number].point.floats * 2 for number in cells.vertices]
    wests, souths, easts, norths = zip(*boxes, strict=True)
    return Rectangle(min(wests), min(souths), max(easts), max(norths))
