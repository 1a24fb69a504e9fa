"""Feasible poses by flood fills, O(n^2) a probe ([BrownDonald2000]_ sec. 2.3.3, figs. 18-20).

The same sets as in :mod:`.feasible_poses`, by the faster of the paper's two rasterized algorithms: D by
translating the map and flooding it with the octagon metric as many steps as the error radius has cells, E by the
directional flood. Neither the length of the reading nor the error radius adds to the cost.

An octagon of ``eps`` steps stands for the disk that reaches ``eps`` cells beyond the obstacle cell, so whose radius is
``eps + 1/2`` (see :mod:`.floods`). E is identical, always. D, and so FP, is identical up to ``eps = 5``, and
up to 23 it differs only within one cell of the boundary of D.
"""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.translation import translated
from robotd.localization.reference.directional_flood import directional_flood, is_ray
from robotd.localization.reference.floods import UNREACHED, Metric, grown
from robotd.localization.reference.probe import Probe


def flooded_feasible_poses(occupied: NDArray[np.bool_], probe: Probe, error_cells: int) -> NDArray[np.bool_]:
    """Return FP_eps = D_eps - E_eps, ``bool[rows, cols]``; for a miss, the cells from which nothing blocks the beam.

    O(n^2). [BrownDonald2000]_ sec. 2.3.3, fig. 20.

    Args:
        occupied: ``bool[rows, cols]``, M; what lies outside is occupied.
        probe: drawn with an error radius of ``error_cells + 1/2``.
        error_cells: eps, in steps of the flood.
    """
    unblocked = ~flooded_blocked_set(occupied, probe.body)
    return unblocked if probe.head is None else unblocked & flooded_endpoint_set(occupied, probe.head, error_cells)


def flooded_endpoint_set(occupied: NDArray[np.bool_], head: tuple[int, int], error_cells: int) -> NDArray[np.bool_]:
    """Return D_eps, ``bool[rows, cols]``: M translated by -z, then grown by an octagon. O(n^2), fig. 18."""
    rows, cols = occupied.shape
    # Obstacles that the translation takes a little way out of the grid still reach into it.
    margin = error_cells
    around = (rows + 2 * margin, cols + 2 * margin)
    moved = translated(occupied, head[0] - margin, head[1] - margin, outside=True, shape=around)
    near = grown(moved, error_cells, Metric.OCTAGON)
    return near[margin : margin + rows, margin : margin + cols].copy()


def flooded_blocked_set(occupied: NDArray[np.bool_], body: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return E_eps, ``bool[rows, cols]``: M flooded against the reading's direction. O(n^2), fig. 19.

    Args:
        occupied: ``bool[rows, cols]``, M.
        body: of a :class:`.Probe`: the robot's own cell, and then the chain of a ray,
            wherever that begins.
    """
    # The beam begins in the robot's own cell, or else in the next cell of the body.
    ray = body if is_ray(body) else body[1:]
    start = ray[0]
    numbers = directional_flood(occupied, ray - start, outside=True)
    blocked: NDArray[np.bool_] = occupied | translated(numbers != UNREACHED, int(start[0]), int(start[1]), outside=True)
    return blocked
