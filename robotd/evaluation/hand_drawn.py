"""A map as a person draws it: the outlines of what stands there, as polygons with few corners, and nothing small."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from robotd.grid.growth import grown_by_disk
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION, SURELY_OCCUPIED

_GAP_M = 0.15
"""Hits so near to each other are one wall to who draws it."""
_OFF_M = 0.1
"""A corner that lies no farther beside a straight line is not drawn."""
_SMALL_M = 1.5
"""Nobody draws what measures less all round."""
_VACANT = np.uint8(1)

Corners = NDArray[np.intp]
"""``intp[n, 2]``, row and column of corners between cells: ``(r, c)`` is the lower left one of cell ``(r, c)``."""


def hand_drawn(grid: OccupancyGrid) -> NDArray[np.uint8]:
    """Return the evidence ``uint8[rows, cols]`` of a map with the same walls, drawn by hand. O(cells + corners)."""
    cell_m, walls = grid.spec.resolution_m, grid.cells > NO_INFORMATION
    gap_cells = _GAP_M / cell_m
    # Grown, and shrunk by as much: gaps close, and walls stay where they are. Outside counts as clear, so that
    # a wall at the edge shrinks back from it, too.
    closed = ~grown_by_disk(~grown_by_disk(walls, gap_cells), gap_cells, outside=True)
    cells = np.where(walls | closed, _VACANT, grid.cells).astype(np.uint8)
    for loop in loops_of(closed):
        if len(loop) * cell_m >= _SMALL_M:
            corners = simplified(loop, _OFF_M / cell_m)
            for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                _draw(cells, start, end)
    return cells


def loops_of(mask: NDArray[np.bool_]) -> Iterator[Corners]:
    """Yield the borders of a set of cells, each a closed loop of corners, one step apart; none is told twice."""
    # So that what reaches the edge has a border there.
    padded = np.pad(mask, 1).astype(np.int8)
    across, along = np.diff(padded, axis=0)[:, 1:-1], np.diff(padded, axis=1)[1:-1]
    # The set lies to the left of each step: along +x below it, -x above it, +y to its right, -y to its left.
    steps = [
        *((row, col, 0, 1) for row, col in np.argwhere(across == 1).tolist()),
        *((row, col + 1, 0, -1) for row, col in np.argwhere(across == -1).tolist()),
        *((row, col, 1, 0) for row, col in np.argwhere(along == -1).tolist()),
        *((row + 1, col, -1, 0) for row, col in np.argwhere(along == 1).tolist()),
    ]
    onward: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for row, col, up, right in steps:
        onward.setdefault((row, col), []).append((row + up, col + right))
    for start in list(onward):
        while onward[start]:
            yield np.array(_followed(onward, start), np.intp)


def _followed(onward: dict[tuple[int, int], list[tuple[int, int]]], start: tuple[int, int]) -> list[tuple[int, int]]:
    """Return a loop from a corner back to it, and take its steps out of what is left."""
    loop, at = [start], onward[start].pop()
    while at != start:
        loop.append(at)
        at = onward[at].pop()
    return loop


def simplified(loop: Corners, off_cells: float) -> Corners:
    """Return the corners of a loop that are needed so that none lies farther beside it (Douglas and Peucker 1973)."""
    # A loop has no ends to draw the first line between: its first corner and the one farthest from it stand for
    # them.
    middle = int(np.hypot(*(loop - loop[0]).T).argmax())
    kept, pieces = {0, middle}, [(0, middle), (middle, len(loop))]
    closed = np.concatenate((loop, loop[:1]))
    while pieces:
        first, last = pieces.pop()
        between = closed[first + 1 : last]
        if len(between) == 0:
            continue
        off = _beside(between, closed[first], closed[last])
        if off.max() > off_cells:
            corner = first + 1 + int(off.argmax())
            kept.add(corner)
            pieces += [(first, corner), (corner, last)]
    return loop[sorted(kept)]


def _beside(points: Corners, start: Corners, end: Corners) -> NDArray[np.float64]:
    """Return how far points lie beside a line, ``float64[n]``; of a line without length, from its start."""
    (up, right), off = (end - start).tolist(), points - start
    length, up_off, right_off = math.hypot(up, right), off[:, 0].astype(np.float64), off[:, 1].astype(np.float64)
    return np.hypot(up_off, right_off) if length == 0.0 else np.abs(up_off * right - right_off * up) / length


def _draw(cells: NDArray[np.uint8], start: Corners, end: Corners) -> None:
    """Draw a line with a pen one cell wide."""
    number = int(np.abs(end - start).max()) + 1
    at = np.rint(np.linspace(start, end, number)).astype(np.intp)
    rows, cols = np.clip(at, 0, np.array(cells.shape) - 1).T
    cells[rows, cols] = SURELY_OCCUPIED
