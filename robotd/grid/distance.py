"""How far it is to the nearest source, in the Euclidean metric and exactly: the distance transform.

Squares of distances between centres of cells are whole numbers, so nothing is rounded but a root at the end. The work
is done by the kernel ``distance`` of :mod:`robotd.grid.kernels`, in C where it was compiled.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.grid import kernels
from robotd.grid.kernels.distance.distance_kernel import NOWHERE
from robotd.grid.window import CellWindow

_ANY_DISTANCE = 1 << 14
"""More than any two cells of a grid are apart, and its square fits into 32 bits."""


def distance_transform(sources: NDArray[np.bool_], *, outside: bool = False) -> NDArray[np.float64]:
    """Return the distance from each cell's centre to that of the nearest source, in cells, ``float64[rows, cols]``.

    ``inf`` if there is no source at all. What is within ``d`` cells of a source is what :func:`.footprints.dilate` adds
    with a disk of that radius, for every ``d``. O(cells).

    Args:
        sources: ``bool[rows, cols]``.
        outside: whether what lies beyond the grid is a source.
    """
    squares = squared_distances(sources, outside=outside)
    return np.where(squares == NOWHERE, np.inf, np.sqrt(squares))


def squared_distances(sources: NDArray[np.bool_], *, outside: bool = False) -> NDArray[np.int32]:
    """Return the squares of those distances, ``int32[rows, cols]``; ``NOWHERE`` if there is no source.

    O(cells). Arguments as of :func:`distance_transform`.
    """
    squares = np.empty(sources.shape, np.int32)
    kernels.in_use().distance.squared_distances(
        sources, squares, CellWindow.whole(sources.shape), limit_cells=_ANY_DISTANCE, outside=outside
    )
    return squares
