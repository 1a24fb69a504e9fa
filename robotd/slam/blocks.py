"""Sparse symmetric systems of 3 x 3 blocks, solved without a library: minimum degree, LDL, substitution.

A block is a pose, and a row of blocks is little more than its neighbours along the way, so next to nothing is filled
in: 841 stops with 1084 edges factor into some three thousand blocks. What is worked out of the structure alone (the
order of elimination, where each product belongs) is worked out once for it (:class:`Structure`).

Sums are formed in an order that depends on the structure alone: same input, same bits.
"""

import heapq
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Blocks = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class _Column:
    """One column of the factor."""

    node: int
    """Which unknown it eliminates."""
    rows: NDArray[np.intp]
    """Its neighbours then, as unknowns, in the order of their elimination."""
    first: int
    """Where its blocks begin; they lie one after the other."""
    pairs: tuple[NDArray[np.intp], NDArray[np.intp]]
    """Of which two of its rows each product is formed, the later one first."""
    targets: NDArray[np.intp]
    """To which block each product belongs: to one below the diagonal, or beyond them all to one on it."""


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """Which unknowns hang together, and how they are eliminated."""

    unknowns: int
    columns: tuple[_Column, ...]
    below: int
    """Blocks of the factor below its diagonal."""
    places: dict[tuple[int, int], int]
    """Where the block of two unknowns lies, the one eliminated first being the column: ``(row, column)``."""

    @classmethod
    def of(cls, unknowns: int, pairs: Iterable[tuple[int, int]]) -> "Structure":
        """Work it out for a graph: which unknowns have an edge."""
        neighbours: list[set[int]] = [set() for _ in range(unknowns)]
        for one, other in pairs:
            if one != other:
                neighbours[one].add(other)
                neighbours[other].add(one)
        # Copied: elimination joins the neighbours of what is taken out.
        order = _minimum_degree([set(some) for some in neighbours])
        turn = {node: at for at, (node, _) in enumerate(order)}
        places: dict[tuple[int, int], int] = {}
        rows_of = []
        for node, some in order:
            rows = sorted(some, key=turn.__getitem__)
            rows_of.append(rows)
            for row in rows:
                places[row, node] = len(places)
        columns = [_column(node, rows, places) for (node, _), rows in zip(order, rows_of, strict=True)]
        return cls(unknowns, tuple(columns), len(places), places)


def _minimum_degree(neighbours: list[set[int]]) -> list[tuple[int, set[int]]]:
    """Return the unknowns, the one with fewest neighbours first, and which it had when its turn came."""
    waiting = [(len(some), node) for node, some in enumerate(neighbours)]
    heapq.heapify(waiting)
    done = [False] * len(neighbours)
    order: list[tuple[int, set[int]]] = []
    while waiting:
        degree, node = heapq.heappop(waiting)
        # Not taken out when the degree changed, so what is stale is passed over.
        if done[node] or degree != len(neighbours[node]):
            continue
        done[node] = True
        some = neighbours[node]
        order.append((node, some))
        for other in some:
            neighbours[other] |= some
            neighbours[other] -= {other, node}
            # With its number beside the degree: of equal ones the same is taken in every run, and the bits of
            # the sums with it.
            heapq.heappush(waiting, (len(neighbours[other]), other))
    return order


def _column(node: int, rows: list[int], places: dict[tuple[int, int], int]) -> _Column:
    first = places[rows[0], node] if rows else 0
    later, earlier = np.tril_indices(len(rows))
    below = len(places)
    targets = [
        below + rows[one] if one == other else places[rows[one], rows[other]]
        for one, other in zip(later.tolist(), earlier.tolist(), strict=True)
    ]
    return _Column(node, np.array(rows, np.intp), first, (later, earlier), np.array(targets, np.intp))


@dataclass(frozen=True, slots=True, eq=False)
class Factor:
    """A factored system: what :func:`solved` needs."""

    structure: Structure
    lower: Blocks
    """``float64[below, 3, 3]``."""
    diagonal_inverse: Blocks
    """``float64[unknowns, 3, 3]``."""

    def solved(self, right: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the solution for right-hand sides ``float64[unknowns, 3, k]``."""
        found = right.copy()
        columns, lower = self.structure.columns, self.lower
        for column in columns:
            if len(column.rows):
                blocks = lower[column.first : column.first + len(column.rows)]
                found[column.rows] -= blocks @ found[column.node]
        found = self.diagonal_inverse @ found
        for column in reversed(columns):
            if len(column.rows):
                blocks = lower[column.first : column.first + len(column.rows)]
                # One long row of blocks against one long column: a single product.
                found[column.node] -= blocks.reshape(-1, 3).T @ found[column.rows].reshape(-1, found.shape[2])
        return found


def factored(structure: Structure, diagonal: Blocks, below: Blocks) -> Factor:
    """Factor a symmetric positive definite system.

    Args:
        structure: of the system.
        diagonal: ``float64[unknowns, 3, 3]``.
        below: ``float64[structure.below, 3, 3]``, by :attr:`Structure.places`; zeros where there is no edge.

    Raises:
        numpy.linalg.LinAlgError: it is singular.
    """
    values = np.concatenate((below, diagonal))
    inverse = np.empty_like(diagonal)
    count = structure.below
    for column in structure.columns:
        # Blocks of 3 x 3 on the diagonal, inverted outright: pivoting within a pose would gain nothing.
        inverse[column.node] = np.linalg.inv(values[count + column.node])
        if len(column.rows):
            here = slice(column.first, column.first + len(column.rows))
            blocks = values[here] @ inverse[column.node]
            later, earlier = column.pairs
            # Each target comes up once in a column, so nothing is lost.
            values[column.targets] -= blocks[later] @ values[here][earlier].transpose(0, 2, 1)
            values[here] = blocks
    return Factor(structure, values[:count], inverse)
