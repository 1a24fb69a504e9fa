"""The plane sweep: from borders of many sets to their arrangement, in O((n + s) log n) exact predicates.

[BrownDonald2000]_ appendix, figs. 32 and 33; Bentley and Ottmann's algorithm for segments and x-monotone arcs. A
line that leans a little sweeps from left to right and stops at events: ends of borders, spots and crossings. The status
holds the edges that it meets, lowest first.

There are no special cases, because every event is treated alike: all edges through the point end there, whatever goes
on from there is sorted again by direction and curvature, and what lies on one support becomes one edge. That covers
crossings of any number, shared ends, overlaps, touching curves and vertical lines.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cmp_to_key
from heapq import heapify, heappop, heappush

from robotd.exact.arrangement import Arrangement, BorderEdge, Mask, Vertex
from robotd.exact.planar import PlanarSet
from robotd.exact.points import Point
from robotd.exact.supports import SupportLine, crossings, order_after
from robotd.exact.sweep_events import Event, Piece, events_of


def arrange(sets: Sequence[PlanarSet]) -> Arrangement:
    """Return the arrangement of sets; bit k of its masks is the k-th of them.

    Raises:
        ValueError: the borders of a set contradict each other, as those of a polygon that crosses itself.
    """
    queue = [event for number, planar in enumerate(sets) for event in events_of(planar, 1 << number)]
    heapify(queue)
    return _Sweep(queue, far=sum(1 << number for number, planar in enumerate(sets) if planar.far)).run()


@dataclass(frozen=True, slots=True, eq=False)
class _Strand:
    """An edge that the sweep line meets, and the pieces of borders that lie on it."""

    pieces: tuple[Piece, ...]
    edge: BorderEdge
    number: int
    last: Point
    """Where the last of its pieces ends."""
    low: float
    high: float

    @classmethod
    def of(cls, pieces: Sequence[Piece], edge: BorderEdge, number: int) -> "_Strand":
        last = max(piece.border.end for piece in pieces) if len(pieces) > 1 else pieces[0].border.end
        low, high = min(piece.low for piece in pieces), max(piece.high for piece in pieces)
        return cls(tuple(pieces), edge, number, last, low, high)


class _Sweep:
    """The state of one sweep: what is to come, what the line meets, what lies behind it."""

    def __init__(self, queue: list[Event], *, far: Mask) -> None:
        self.queue = queue
        # A list, not a tree: it is searched by halves, and moving pointers is cheap beside an exact predicate.
        self.status: list[_Strand] = []
        self.vertices: list[Vertex] = []
        self.edges: list[BorderEdge] = []
        self.faces = _Faces([far], [0])
        self.crossings: dict[tuple[int, int], list[Point]] = {}
        """Crossings of two supports, by their identity, that are not in the queue yet."""

    def run(self) -> Arrangement:
        while self.queue:
            self._stop_at(self._next())
        numbers = self.faces.numbers()
        for edge in self.edges:
            edge.left, edge.right = numbers[edge.left], numbers[edge.right]
        for vertex in self.vertices:
            vertex.face = numbers[vertex.face]
        return Arrangement(tuple(self.vertices), tuple(self.edges), self.faces.of_numbers(numbers))

    def _next(self) -> Event:
        """Take everything that happens at the next point."""
        together = [heappop(self.queue)]
        while self.queue and self.queue[0].point == together[0].point:
            together.append(heappop(self.queue))
        return Event.of(together)

    def _stop_at(self, event: Event) -> None:
        first, last = self._reach(event.point)
        arriving = self.status[first:last]
        # Below everything lies the far face, number 0.
        below = self.status[first - 1].edge.left if first else 0
        above = arriving[-1].edge.left if arriving else below
        here = len(self.vertices)
        for strand in arriving:
            strand.edge.end = here
        leaving = self._leave(_bundles(arriving, event), here, below, above)
        self.status[first:last] = leaving
        mask = _mask_at(event, [*arriving, *leaving], self.faces.masks[below])
        into, out = (tuple(strand.number for strand in strands) for strands in (arriving, leaving))
        self.vertices.append(Vertex(event.point, mask, into, out, below))
        for upper in range(first, first + len(leaving) + 1):  # arcs that part here may meet again
            self._look_ahead(upper, event.point)

    def _reach(self, point: Point) -> tuple[int, int]:
        """Return the slice of the status that goes through a point."""
        first, last = 0, len(self.status)
        while first < last:
            middle = (first + last) // 2
            if self.status[middle].edge.support.side(point) > 0:
                first = middle + 1
            else:
                last = middle
        while last < len(self.status) and self.status[last].edge.support.side(point) == 0:
            last += 1
        return first, last

    def _leave(self, bundles: list[list[Piece]], here: int, below: int, above: int) -> list[_Strand]:
        """Begin an edge for each bundle, lowest first, and a face between each two."""
        strands, right = [], below
        for number, pieces in enumerate(bundles):
            touched, on, left_mask = _sides(pieces, self.faces.masks[right])
            mask = self.faces.masks[right] & ~touched
            # The topmost edge gets no face of its own: above it goes on what was above before.
            left = above if number == len(bundles) - 1 else self.faces.add(mask | left_mask)
            if self.faces.masks[left] != mask | left_mask:
                raise ValueError(f"the borders at {pieces[0].border.start} do not close around an area")
            edge = BorderEdge(pieces[0].border.support, here, -1, mask | on, right, left)
            strands.append(_Strand.of(pieces, edge, len(self.edges)))
            self.edges.append(edge)
            right = left
        if not bundles:
            self.faces.join(below, above)
        return strands

    def _look_ahead(self, upper: int, point: Point) -> None:
        """Put the crossings to come of two neighbours in the status into the queue."""
        if not 0 < upper < len(self.status):
            return
        one, other = self.status[upper - 1], self.status[upper]
        # Cheap tests first: most neighbours never meet, and a crossing may cost a root.
        if one.high < other.low or _stay_apart(one, other):
            return
        # By identity, which lasts as long as the sweep: the edges keep their supports alive.
        pair = id(one.edge.support), id(other.edge.support)
        pair = min(pair), max(pair)
        if pair not in self.crossings:
            self.crossings[pair] = list(crossings(one.edge.support, other.edge.support))
        # What lies beyond an end stays in the list: another piece on the same support may get there.
        to_come = [at for at in self.crossings[pair] if point < at <= one.last and at <= other.last]
        for at in to_come:
            self.crossings[pair].remove(at)
            heappush(self.queue, Event(at))


def _stay_apart(lower: _Strand, upper: _Strand) -> bool:
    """Return whether two straight edges do not meet: the one that ends first does so on its own side."""
    one, other = lower.edge.support, upper.edge.support
    if not (isinstance(one, SupportLine) and isinstance(other, SupportLine)):
        return False
    return other.side(lower.last) < 0 if lower.last < upper.last else one.side(upper.last) > 0


def _bundles(arriving: Iterable[_Strand], event: Event) -> list[list[Piece]]:
    """Return the pieces that go on from an event, those on one support together, lowest first."""
    ending = {id(piece) for piece in event.ends}
    pieces = [piece for strand in arriving for piece in strand.pieces if id(piece) not in ending]
    pieces.extend(event.starts)

    def order(one: Piece, other: Piece) -> int:
        if one.border.support is other.border.support:
            return 0
        return order_after(one.border.support, other.border.support, event.point)

    pieces.sort(key=cmp_to_key(order))
    bundles: list[list[Piece]] = []
    for piece in pieces:
        if bundles and order(bundles[-1][0], piece) == 0:
            bundles[-1].append(piece)
        else:
            bundles.append([piece])
    return bundles


def _sides(pieces: Iterable[Piece], right: Mask) -> tuple[Mask, Mask, Mask]:
    """Return the sets whose borders lie on an edge, those of them that it belongs to, and those left of it."""
    touched = on = left = 0
    for piece in pieces:
        border = piece.border
        if touched & piece.bit or bool(right & piece.bit) != border.right:
            raise ValueError(f"the borders at {border.start} do not close around an area")
        touched |= piece.bit
        on |= piece.bit if border.on else 0
        left |= piece.bit if border.left else 0
    return touched, on, left


def _mask_at(event: Event, strands: Iterable[_Strand], face: Mask) -> Mask:
    """Return the sets that contain a vertex: as their spots say, else their borders, else the face around it."""
    touched = off = 0
    for strand in strands:
        for piece in strand.pieces:
            touched |= piece.bit
            off |= 0 if piece.border.on else piece.bit
    mask = (face & ~touched) | (touched & ~off)
    for bit, on in event.spots:
        mask = mask | bit if on else mask & ~bit
    return mask


@dataclass(frozen=True, slots=True, eq=False)
class _Faces:
    """Faces as the sweep sees them: two may prove to be one further right. A forest of joined ones."""

    masks: list[Mask]
    parents: list[int] = field(default_factory=list)

    def add(self, mask: Mask) -> int:
        self.masks.append(mask)
        self.parents.append(len(self.parents))
        return len(self.parents) - 1

    def root(self, face: int) -> int:
        while self.parents[face] != face:
            self.parents[face] = face = self.parents[self.parents[face]]
        return face

    def join(self, one: int, other: int) -> None:
        if self.masks[one] != self.masks[other]:
            raise ValueError("the borders of a set end in the open")
        one, other = sorted((self.root(one), self.root(other)))
        self.parents[other] = one

    def numbers(self) -> list[int]:
        """Return the number of every face, joined ones counted once; the far face is 0."""
        roots = sorted({self.root(face) for face in range(len(self.parents))})
        number_of = {root: number for number, root in enumerate(roots)}
        return [number_of[self.root(face)] for face in range(len(self.parents))]

    def of_numbers(self, numbers: Sequence[int]) -> tuple[Mask, ...]:
        """Return the mask of every number."""
        masks = dict(zip(numbers, self.masks, strict=True))
        return tuple(masks[number] for number in range(len(masks)))
