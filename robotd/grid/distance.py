"""How far it is to the nearest source, in the Euclidean metric and exactly: the distance transform.

The squared distance is the smallest of ``(row - i)^2 + (col - j)^2`` over all sources ``(i, j)``, and falls apart into
two passes: along the columns the nearest source of each column, then along the rows the smallest of those plus the
square of the way to that column. Squares are whole numbers, so nothing is rounded but the one root at the end.
"""

import numpy as np
from numpy.typing import NDArray


def distance_transform(sources: NDArray[np.bool_], *, outside: bool = False) -> NDArray[np.float64]:
    """Return the distance from each cell's centre to that of the nearest source, in cells, ``float64[rows, cols]``.

    ``inf`` if there is no source at all. What is within ``d`` cells of a source is what :func:`.footprints.dilate` adds
    with a disk of that radius, for every ``d``.

    O(cells x greatest distance): the second pass looks no farther than any distance it has found.

    Args:
        sources: ``bool[rows, cols]``.
        outside: whether what lies beyond the grid is a source.
    """
    # The nearest cell outside is one of the ring round the grid.
    padded = np.pad(sources, 1, constant_values=outside)
    squares = _least_along_rows(_along_cols(padded) ** 2)
    distances: NDArray[np.float64] = np.sqrt(squares[1:-1, 1:-1])
    return distances


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
        if farther >= least.max():
            break
        np.minimum(least[:, step:], squares[:, :-step] + farther, out=least[:, step:])
        np.minimum(least[:, :-step], squares[:, step:] + farther, out=least[:, :-step])
    return least
