"""Wall fields and beams cast on them, in NumPy: the twin of the kernel in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.cast.cast_kernel import BLOCKS, DEPTH_CELLS, ENDS, REACH_CELLS, SKIP_MAX

_ALONG = 1e-300
"""A beam that changes a coordinate by less along its way does not change it."""


def wall_codes(walls: NDArray[np.bool_]) -> NDArray[np.int8]:
    """See :class:`.CastKernel`."""
    outside = _squares(walls, REACH_CELLS)
    inside = _squares(~walls, DEPTH_CELLS)
    return np.where(walls, -inside, outside).astype(np.int8)


def skip_codes(ends: NDArray[np.bool_], blocks: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """See :class:`.CastKernel`."""
    stops = np.pad(ends | blocks, 1, constant_values=True)
    skips = np.full(stops.shape, SKIP_MAX, np.uint8)
    reached = stops
    for step in range(1, SKIP_MAX):
        grown = _grown(reached)
        skips[grown & ~reached] = step
        reached = grown
    skips[stops] = BLOCKS
    skips[1:-1, 1:-1][ends] = ENDS
    return skips


def cast_beams(
    skips: NDArray[np.uint8], beams: NDArray[np.float64], poses: NDArray[np.float64], blocked_by: int
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """See :class:`.CastKernel`."""
    x, y, cos, sin = (poses[:, i, None] for i in range(4))
    start = x + (cos * beams[:, 0] - sin * beams[:, 1]), y + (sin * beams[:, 0] + cos * beams[:, 1])
    ahead = cos * beams[:, 2] - sin * beams[:, 3], sin * beams[:, 2] + cos * beams[:, 3]
    ways, stops = _cast(skips, np.stack(start).reshape(2, -1), np.stack(ahead).reshape(2, -1), blocked_by)
    shape = (len(poses), len(beams))
    return ways.reshape(shape), stops.reshape(shape)


def _cast(
    skips: NDArray[np.uint8], start: NDArray[np.float64], ahead: NDArray[np.float64], blocked_by: int
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Return ways and what stops the beams, all beams in step: ``start`` and ``ahead`` are ``float64[2, k]``."""
    rows, cols = skips.shape
    (start_x, start_y), (ahead_x, ahead_y), count = start, ahead, start.shape[1]
    ways, run_ways, run_stops = np.zeros(count), np.zeros(count), np.full(count, BLOCKS, np.uint8)
    met, in_run = np.zeros(count, np.intp), np.zeros(count, np.bool_)
    # Clipped before the cast, which is undefined for great floats; what is outside lands in the ring or beyond, and
    # goes nowhere.
    col, row = (np.floor(np.clip(at, -1.0, 1e9)).astype(np.intp) + 1 for at in (start_x, start_y))
    on = np.flatnonzero((col > 0) & (row > 0) & (col < cols - 1) & (row < rows - 1))
    while on.size:
        skip = skips[row[on], col[on]].astype(np.intp)
        meets = (skip == ENDS) | (skip == BLOCKS)
        begins = on[meets & ~in_run[on]]
        run_ways[begins], run_stops[begins] = ways[begins], skips[row[begins], col[begins]]
        in_run[on] = meets
        met[on] += meets
        edge = (col[on] == 0) | (row[on] == 0) | (col[on] == cols - 1) | (row[on] == rows - 1)
        going = ~((meets & (met[on] >= blocked_by)) | edge)
        on, skip = on[going], np.where(meets, 1, skip)[going]
        right, up = ahead_x[on] > 0.0, ahead_y[on] > 0.0
        side_x = np.where(right, col[on] - 1 + skip, col[on] - skip)
        side_y = np.where(up, row[on] - 1 + skip, row[on] - skip)
        to_x, to_y = _way(side_x, start_x[on], ahead_x[on]), _way(side_y, start_y[on], ahead_y[on])
        over_x = to_x <= to_y
        way = np.where(over_x, to_x, to_y)
        next_col = _cell(start_x[on] + way * ahead_x[on], col[on], skip)
        next_row = _cell(start_y[on] + way * ahead_y[on], row[on], skip)
        col[on] = np.where(over_x, col[on] + np.where(right, skip, -skip), next_col)
        row[on] = np.where(over_x, next_row, row[on] + np.where(up, skip, -skip))
        ways[on] = way
    return run_ways, run_stops


def _way(side: NDArray[np.intp], start: NDArray[np.float64], ahead: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how far it is to a line across; for ever, if the beam runs along it."""
    along = np.abs(ahead) < _ALONG
    # By the reciprocal, as in C: a division may differ in the last bit.
    ways: NDArray[np.float64] = np.where(along, np.inf, (side - start) * (1.0 / np.where(along, 1.0, ahead)))
    return ways


def _cell(at: NDArray[np.float64], cell: NDArray[np.intp], skip: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the cell of a point on a side, which rounding does not take round the corner."""
    return np.clip(at.astype(np.intp) + 1, cell - skip + 1, cell + skip - 1)


def _squares(sources: NDArray[np.bool_], reach: int) -> NDArray[np.int16]:
    """Return the squared distance to the nearest source, up to ``reach``."""
    far = reach * reach
    padded = np.pad(sources, reach)
    rows, cols = sources.shape
    squares = np.full(sources.shape, far, np.int16)
    for row in range(-reach, reach + 1):
        for col in range(-reach, reach + 1):
            square = row * row + col * col
            if square < far:
                near = padded[reach + row : reach + row + rows, reach + col : reach + col + cols]
                np.minimum(squares, np.where(near, square, far).astype(np.int16), out=squares)
    return squares


def _grown(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the cells and their eight neighbours."""
    rows = cells.copy()
    rows[1:] |= cells[:-1]
    rows[:-1] |= cells[1:]
    grown = rows.copy()
    grown[:, 1:] |= rows[:, :-1]
    grown[:, :-1] |= rows[:, 1:]
    return grown
