"""The cells of one ray as offsets, the paper's pixelized vector ([BrownDonald2000]_ sec. 2.3.2, fig. 16).

Made by the rule of :mod:`robotd.grid.ray`; what the programs draw is held against it, cell by cell.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.ray import ray_steps, sample_counts

_CENTRE = 0.5


def ray_offsets(bearing_rad: float, length_cells: float) -> NDArray[np.intp]:
    """Return ``intp[n, 2]``: the ``(row, col)`` offsets of a ray's cells from the cell at whose centre it starts.

    Never empty: the first is ``(0, 0)``, even for a length of zero or less.

    >>> ray_offsets(0.25, 3.5).tolist()
    [[0, 0], [0, 1], [1, 2], [1, 3]]
    """
    bearing = np.array([bearing_rad])
    count = max(1, int(sample_counts(bearing, np.array([length_cells]))[0]))
    offsets: NDArray[np.intp] = np.floor(_CENTRE + np.arange(count)[:, None] * ray_steps(bearing)).astype(np.intp)
    return offsets
