"""A binary grid as a set of polygons: the outlines of its cells, so that both algorithms run on one map."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from robotd.exact.planar import Border, PlanarSet, segment
from robotd.exact.points import Point
from robotd.exact.rationals import Rational


def outlines(
    occupied: NDArray[np.bool_],
    cell: Rational,
    *,
    x: Rational | int = 0,
    y: Rational | int = 0,
    outside: bool = True,
) -> PlanarSet:
    """Return the union of all occupied cells, closed.

    Args:
        occupied: ``bool[rows, cols]``, row along +y, column along +x.
        cell: side of one; its arithmetic is that of the outlines.
        x: lower left corner of cell ``(0, 0)``.
        y: the same.
        outside: whether what lies beyond the grid is solid, as it is for the rasterized algorithm.
    """
    padded = np.pad(occupied, 1, constant_values=outside)

    def corner(row: int, col: int) -> Point:
        return Point(x + cell * (col - 1), y + cell * (row - 1))

    borders: list[Border] = []
    # Cell sides in one line become one border: what a sweep costs grows with their number.
    for row, first, last, above in _runs(padded):
        borders.append(segment(corner(row, first), corner(row, last), on=True, left=above, right=not above))
    for col, first, last, right in _runs(padded.T):
        borders.append(segment(corner(first, col), corner(last, col), on=True, left=not right, right=right))
    return PlanarSet(tuple(borders), (), far=outside)


def _runs(cells: NDArray[np.bool_]) -> Iterator[tuple[int, int, int, bool]]:
    """Return where rows differ from those before: the row, first and last column of a run, and which is occupied."""
    # Signed: the difference has to say on which side the solid cell lies.
    before, after = cells[:-1].astype(np.int8), cells[1:].astype(np.int8)
    steps = np.pad(after - before, ((0, 0), (1, 1)))
    changes = np.diff(steps, axis=1) != 0
    for row in range(len(steps)):
        at = np.flatnonzero(changes[row]).tolist()
        for first, last in pairwise(at):
            step = int(steps[row, first + 1])
            if step:
                yield row + 1, first, last, step > 0
