"""Flood fills: numbering cells by how many steps they are from the sources ([BrownDonald2000]_ sec. 2.3.2, fig. 15).

Every step grows the last contour to its 4 neighbours across the sides or to all 8 across sides and corners. Always 4
gives the L1 metric and diamonds, always 8 gives L-infinity and squares, and a fixed pattern of both gives octagons.

The octagon's pattern is **8, 4, 4** over and over; which growth a cell takes depends on its number alone. After ``r``
steps, ``ceil(r / 3)`` of them across corners, a single cell has become the octagon ``max(|x|, |y|) <= r``,
``|x| + |y| <= r + ceil(r / 3)``. The L2 disk to compare it with reaches ``r`` cells beyond the source *cell*, so its
radius is ``r + 1/2`` round the source's centre. With this pattern the two are the same set for ``r <= 5`` (the paper
says 4), and their boundaries are within one cell of each other for ``r <= 23`` (the paper says about 20); no shorter
pattern gets there. A disk of radius ``r`` round the centre is no octagon: for ``r = 3`` it holds (2, 2) but not
(3, 1), and every octagon of 3 steps that holds the one holds the other.
"""

import enum

import numpy as np
from numpy.typing import NDArray

UNREACHED = -1
"""Number of the cells that no flood reached."""


class Metric(enum.StrEnum):
    """What counts as one step."""

    L1 = "l1"
    """To the 4 neighbours across a side: contours are diamonds."""
    L_INFINITY = "l_infinity"
    """To the 8 neighbours across a side or a corner: contours are squares."""
    OCTAGON = "octagon"
    """8, 4 and 4 neighbours in turn: contours are octagons."""

    @property
    def pattern(self) -> tuple[int, ...]:
        """How many neighbours the cells numbered 0, 1, 2, ... are grown to, over and over."""
        return {Metric.L1: (4,), Metric.L_INFINITY: (8,), Metric.OCTAGON: (8, 4, 4)}[self]


def flood(
    sources: NDArray[np.bool_], metric: Metric, *, limit: int | None = None, obstacles: NDArray[np.bool_] | None = None
) -> NDArray[np.int32]:
    """Return the contour number of every cell, ``int32[rows, cols]``: 0 at the sources, -1 where the flood never came.

    The breadth-first flood of [BrownDonald2000]_ sec. 2.3.2, fig. 15, a whole contour at a time. A cell numbered ``i``
    numbers its neighbours ``i + 1`` if they bear no number yet; without obstacles this is the distance to the nearest
    source. With obstacles and octagons, a gap between two corners lets only the contours through that grow across
    corners.

    O(cells) work however far it floods, in as many array steps as there are contours.

    Args:
        sources: ``bool[rows, cols]``, where to begin.
        metric: what counts as one step.
        limit: greatest number to give; None to flood everything.
        obstacles: ``bool[rows, cols]``, cells that cannot be flooded, sources or not.
    """
    rows, cols = sources.shape
    open_cells = np.ones_like(sources) if obstacles is None else ~obstacles
    # The rim is no cell to be flooded, so a step in the flattened grid cannot run over into the next row.
    dry = np.pad(open_cells, 1).reshape(-1)
    numbers = np.full(dry.shape, UNREACHED, np.int32)
    steps = {count: _neighbours(count, cols + 2) for count in metric.pattern}
    contour = np.flatnonzero(np.pad(sources, 1).reshape(-1) & dry)
    number = 0
    while contour.size:
        numbers[contour] = number
        dry[contour] = False
        if number == limit:
            break
        reached = (contour[:, None] + steps[metric.pattern[number % len(metric.pattern)]]).reshape(-1)
        contour = _without_doubles(reached[dry[reached]], numbers)
        number += 1
    return numbers.reshape(rows + 2, cols + 2)[1:-1, 1:-1].copy()


def grown(
    obstacles: NDArray[np.bool_], radius_cells: int, metric: Metric, *, outside: bool = False
) -> NDArray[np.bool_]:
    """Return the C-space obstacles of a robot that is a disk of the metric, ``bool[rows, cols]``, by a limited flood.

    The same set as the Minkowski sum of the obstacles and the disk, in O(cells) instead of O(cells x area of the
    disk). [BrownDonald2000]_ sec. 2.3.2.

    Args:
        obstacles: ``bool[rows, cols]``.
        radius_cells: how many steps to grow.
        metric: what the robot looks like: a diamond, a square, an octagon.
        outside: whether what lies beyond the grid is an obstacle too.
    """
    if radius_cells < 0:
        raise ValueError(f"radius_cells must not be negative, got {radius_cells}")
    # Whatever lies outside reaches in through the ring of cells round the grid.
    numbers = flood(np.pad(obstacles, 1, constant_values=outside), metric, limit=radius_cells)
    within: NDArray[np.bool_] = numbers[1:-1, 1:-1] != UNREACHED
    return within


def _neighbours(count: int, width: int) -> NDArray[np.intp]:
    """Return the steps to 4 or 8 neighbours in a flattened grid."""
    sides = [-width, -1, 1, width]
    corners = [-width - 1, -width + 1, width - 1, width + 1]
    return np.array(sides if count == 4 else sides + corners)


def _without_doubles(cells: NDArray[np.intp], scratch: NDArray[np.int32]) -> NDArray[np.intp]:
    """Return each cell once, in O(cells); what was in ``scratch`` at these cells is overwritten."""
    order = np.arange(len(cells), dtype=np.int32)
    # Of equal cells the last to write stays: it alone finds its own number again. Sorting would cost more than
    # O(cells).
    scratch[cells] = order
    unique: NDArray[np.intp] = cells[scratch[cells] == order]
    return unique
