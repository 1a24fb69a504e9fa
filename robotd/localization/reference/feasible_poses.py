"""Feasible poses by discrete convolution: the reference ([BrownDonald2000]_ sec. 2.2.1 (4), 2.3.3, figs. 14, 17).

For a binary map M, a range vector z and an error radius eps::

    D_eps(M, z)  cells from which z ends within eps of an obstacle       endpoint_set
    E_eps(M, z)  cells from which z runs into an obstacle before that    blocked_set
    FP_eps(M, z) = D_eps - E_eps                                         feasible_poses

Convolving a bitmap with a point set is ORing shifted copies of it. D would take one shift for every cell of the disk;
but growing M by the disk and then shifting it is the same set, so M is grown once per map and D is one shift. E takes
one shift for every cell of the body, O(n^2 r).

For the paper whatever lies outside the grid is unknown, and unknown is occupied: a beam that leaves the grid is blocked
there, and one that ends within eps of the edge may end at it. :mod:`.beam_obstacles` knows other readings
of what nobody has seen.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from robotd.grid.translation import translated
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.reference.probe import Probe


def feasible_poses(obstacles: Obstacles, probe: Probe) -> NDArray[np.bool_]:
    """Return FP_eps, ``bool[rows, cols]``: the cells where the robot can stand and get this reading.

    For a miss these are the cells from which nothing blocks the beam.
    """
    blocked = blocked_set(
        obstacles.blocking, probe.body, outside=obstacles.outside_blocks, blocked_by=obstacles.blocked_by
    )
    unblocked = obstacles.free & ~blocked
    if probe.head is None:
        return unblocked
    return unblocked & endpoint_set(obstacles.grown, probe.head, outside=obstacles.outside_ends)


def endpoint_set(grown: NDArray[np.bool_], head: tuple[int, int], *, outside: bool = True) -> NDArray[np.bool_]:
    """Return D_eps, ``bool[rows, cols]``, of a grown map: the cells from which the head is on it.

    Args:
        grown: ``bool[rows, cols]``.
        head: ``(row, col)`` offset of the head.
        outside: whether a head beyond the grid is on it.
    """
    return translated(grown, *head, outside=outside)


def blocked_set(
    blocking: NDArray[np.bool_], body: NDArray[np.intp], *, outside: bool = True, blocked_by: int = 1
) -> NDArray[np.bool_]:
    """Return E_eps, ``bool[rows, cols]``: the cells from which enough cells of the body are blocking.

    Args:
        blocking: ``bool[rows, cols]``.
        body: ``intp[n, 2]``, offsets.
        outside: whether the cells beyond the grid are blocking.
        blocked_by: how many are enough.
    """
    met = np.zeros(blocking.shape, np.int32)
    offsets: Iterable[tuple[int, int]] = body.tolist()
    for row, col in offsets:
        # Counted, not ORed: with `blocked_by` 2 a single cell that is grazed does not block.
        met += translated(blocking, row, col, outside=outside)
    return met >= blocked_by
