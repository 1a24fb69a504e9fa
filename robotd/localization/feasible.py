"""Feasible poses by discrete convolution: the reference ([BrownDonald2000]_ sec. 2.2.1 (4), 2.3.3, figs. 14, 17).

For a binary map M, a range vector z and an error radius eps::

    D_eps(M, z)  cells from which z ends within eps of an obstacle       endpoint_set
    E_eps(M, z)  cells from which z runs into an obstacle before that    blocked_set
    FP_eps(M, z) = D_eps - E_eps                                         feasible_poses

Convolving a bitmap with a point set is ORing shifted copies of it. D would take one shift for every cell of the disk;
but growing M by the disk and then shifting it is the same set, so M is grown once per map and D is one shift. E takes
one shift for every cell of the body, O(n^2 r).

Whatever lies outside the grid is unknown, and unknown is occupied: a beam that leaves the grid is blocked there, and
one that ends within eps of the edge may end at it.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid.footprints import dilate, disk_footprint
from robotd.localization.probe import Probe


@dataclass(frozen=True, slots=True, eq=False)
class Obstacles:
    """A binary map and the same grown by the error radius, once for all probes."""

    occupied: NDArray[np.bool_]
    """``bool[rows, cols]``, M."""
    grown: NDArray[np.bool_]
    """``bool[rows, cols]``, M (+) B_eps."""

    @classmethod
    def of(cls, occupied: NDArray[np.bool_], error_radius_cells: float) -> "Obstacles":
        """Grow ``bool[rows, cols]`` by a disk."""
        return cls(occupied, dilate(occupied, disk_footprint(error_radius_cells), outside=True))


def feasible_poses(obstacles: Obstacles, probe: Probe) -> NDArray[np.bool_]:
    """Return FP_eps, ``bool[rows, cols]``: the cells where the robot can get this reading.

    For a miss these are the cells from which nothing blocks the beam.
    """
    unblocked = ~blocked_set(obstacles.occupied, probe.body)
    return unblocked if probe.head is None else unblocked & endpoint_set(obstacles.grown, probe.head)


def endpoint_set(grown: NDArray[np.bool_], head: tuple[int, int]) -> NDArray[np.bool_]:
    """Return D_eps, ``bool[rows, cols]``, of a grown map: the cells from which the head is on it."""
    endpoints = np.ones_like(grown)
    here, there = _overlap(grown.shape, *head)
    endpoints[here] = grown[there]
    return endpoints


def blocked_set(occupied: NDArray[np.bool_], body: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return E_eps, ``bool[rows, cols]``: the cells from which any cell of the body ``intp[n, 2]`` is occupied."""
    blocked = np.zeros_like(occupied)
    offsets: Iterable[tuple[int, int]] = body.tolist()
    for row, col in offsets:
        here, there = _overlap(occupied.shape, row, col)
        blocked[here] |= occupied[there]
    _block_where_outside(blocked, body)
    return blocked


Window = tuple[slice, slice]


def _overlap(shape: tuple[int, ...], row: int, col: int) -> tuple[Window, Window]:
    """Return the cells p whose p + offset is in the grid, and those p + offset."""
    rows, cols = shape
    here = (slice(max(0, -row), max(0, rows - row)), slice(max(0, -col), max(0, cols - col)))
    there = (slice(max(0, row), max(0, rows + row)), slice(max(0, col), max(0, cols + col)))
    return here, there


def _block_where_outside(blocked: NDArray[np.bool_], body: NDArray[np.intp]) -> None:
    """Block the cells from which some cell of the body is outside the grid: strips along its four sides."""
    rows, cols = blocked.shape
    low_row, low_col = body.min(axis=0).tolist()
    high_row, high_col = body.max(axis=0).tolist()
    blocked[: max(0, -low_row)] = True
    blocked[max(0, rows - high_row) :] = True
    blocked[:, : max(0, -low_col)] = True
    blocked[:, max(0, cols - high_col) :] = True
