"""The distance transform, in NumPy: the twin of the kernel in C.

The squared distance is the smallest of ``(row - i)^2 + (col - j)^2`` over all sources ``(i, j)``, and falls apart into
two passes: along the columns the nearest source of each column, then along the rows the smallest of those plus the
square of the way to that column.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.distance.distance_kernel import NOWHERE
from robotd.grid.window import CellWindow


def squared_distances(
    sources: NDArray[np.bool_], squares: NDArray[np.int32], window: CellWindow, *, limit_cells: int, outside: bool
) -> None:
    """See :class:`.DistanceKernel`."""
    if window.is_empty:
        return
    limit = min(limit_cells, sum(sources.shape))
    seen = window.grown(limit, sources.shape)
    # The nearest cell outside is one of the ring round the grid; round a part of it that ring is out of reach.
    at_edges = (
        (seen.first_row == 0, seen.end_row == sources.shape[0]),
        (seen.first_col == 0, seen.end_col == sources.shape[1]),
    )
    padded = np.pad(sources[seen.slices], np.array(at_edges, np.intp), constant_values=outside)
    found = _least_along_rows(_along_cols(padded) ** 2)
    top = window.first_row - seen.first_row + at_edges[0][0]
    left = window.first_col - seen.first_col + at_edges[1][0]
    wanted = found[top : top + window.shape[0], left : left + window.shape[1]]
    squares[window.slices] = np.where(wanted <= limit * limit, wanted, NOWHERE)


def _along_cols(sources: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return how many rows it is to the nearest source of the same column, ``inf`` where there is none."""
    rows = np.arange(float(len(sources)))[:, None]
    below = np.maximum.accumulate(np.where(sources, rows, -np.inf), axis=0)
    above = np.minimum.accumulate(np.where(sources, rows, np.inf)[::-1], axis=0)[::-1]
    nearest: NDArray[np.float64] = np.minimum(rows - below, above - rows)
    return nearest


def _least_along_rows(squares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the least of ``squares[:, j] + (col - j) ** 2`` over all ``j``."""
    least = squares.copy()
    for step in range(1, squares.shape[1]):
        farther = float(step**2)
        # Squares are not negative: from this far off not even a source itself comes nearer than what is known.
        if farther >= least.max():
            break
        np.minimum(least[:, step:], squares[:, :-step] + farther, out=least[:, step:])
        np.minimum(least[:, :-step], squares[:, step:] + farther, out=least[:, :-step])
    return least
