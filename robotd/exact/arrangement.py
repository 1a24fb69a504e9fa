"""The arrangement of point sets: the plane cut into vertices, edges and faces, each with the sets that contain it.

[BrownDonald2000]_ appendix, fig. 33. The paper keeps the depth of coverage by colour; here each cell has a mask with
one bit a set, of which any depth is a count of bits, and which tells besides *who* covers the cell.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from robotd.exact.planar import Border, PlanarSet, Spot
from robotd.exact.points import Point
from robotd.exact.supports import Support, order_after

Mask = int
"""Bit k is set if set k contains the cell."""


def at_least(depth: int) -> Callable[[Mask], bool]:
    """Return the condition that this many sets contain a cell, or more."""
    return lambda mask: mask.bit_count() >= depth


@dataclass(slots=True, eq=False)
class Vertex:
    """A point where borders end, meet or cross, or where a spot is."""

    point: Point
    mask: Mask
    into: tuple[int, ...] = ()
    """Edges that end here, lowest first."""
    out: tuple[int, ...] = ()
    """Edges that begin here, lowest first."""
    face: int = -1
    """The face just below and left of it."""


@dataclass(slots=True, eq=False)  # not frozen: a sweep learns the end, and which faces are one, only later
class BorderEdge:
    """A piece of a support between two vertices that nothing else meets."""

    support: Support
    start: int
    end: int
    mask: Mask
    right: int
    """The face below it (right of it, if it is vertical)."""
    left: int
    """The face above it (left of it, if it is vertical)."""


@dataclass(frozen=True, slots=True, eq=False)
class Arrangement:
    """Vertices in the order of the sweep, edges, faces; face 0 reaches to infinity."""

    vertices: tuple[Vertex, ...]
    edges: tuple[BorderEdge, ...]
    faces: tuple[Mask, ...]

    @property
    def masks(self) -> Iterator[Mask]:
        """The masks of all cells: faces, edges, vertices."""
        yield from self.faces
        yield from (edge.mask for edge in self.edges)
        yield from (vertex.mask for vertex in self.vertices)

    def select(self, belongs: Callable[[Mask], bool]) -> PlanarSet:
        """Return the union of the cells whose masks belong, with no border that nobody needs."""
        of_face = [belongs(mask) for mask in self.faces]
        kept: dict[int, Border] = {}
        for number, edge in enumerate(self.edges):
            border = _border(self, edge, of_face, on=belongs(edge.mask))
            # On both sides the same as on itself: nothing changes there, and no one would see it.
            if not border.left == border.on == border.right:
                kept[number] = border
        return _joined(self, kept, [belongs(vertex.mask) for vertex in self.vertices], of_face)


def _border(arrangement: Arrangement, edge: BorderEdge, of_face: list[bool], *, on: bool) -> Border:
    start, end = arrangement.vertices[edge.start].point, arrangement.vertices[edge.end].point
    return Border(edge.support, start, end, of_face[edge.right], on, of_face[edge.left])


def _joined(arrangement: Arrangement, kept: dict[int, Border], of_vertex: list[bool], of_face: list[bool]) -> PlanarSet:
    """Join borders where a vertex changes nothing, and say of the others what is not said by their borders."""
    spots = []
    for vertex, on in zip(arrangement.vertices, of_vertex, strict=True):
        into = [number for number in vertex.into if number in kept]
        out = [number for number in vertex.out if number in kept]
        around = [kept[number] for number in (*into, *out)]
        if len(into) == len(out) == 1 and _is_one(around[0], around[1], vertex.point, on=on):
            first, second = kept.pop(into[0]), kept[out[0]]
            kept[out[0]] = Border(second.support, first.start, second.end, second.right, on, second.left)
        elif on != (all(border.on for border in around) if around else of_face[vertex.face]):
            spots.append(Spot(vertex.point, on))
    return PlanarSet(tuple(kept.values()), tuple(spots), of_face[0])


def _is_one(before: Border, after: Border, point: Point, *, on: bool) -> bool:
    """Return whether one border goes on in another."""
    alike = on == before.on == after.on and before.left == after.left and before.right == after.right
    return alike and order_after(before.support, after.support, point) == 0
