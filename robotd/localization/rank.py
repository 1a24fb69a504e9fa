"""How many readings each pose explains: the paper's rnk(M, Z, p), counted reading by reading.

[BrownDonald2000]_ sec. 2.2.1 (consistent readings), 2.2.3 (theta slices), 2.3.3.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading
from robotd.grid.binary import BinaryMap
from robotd.localization.feasible import Obstacles, feasible_poses
from robotd.localization.probe import probe_of

_READINGS_MAX = int(np.iinfo(np.uint16).max)


class RankGrid:
    """Counts feasible readings for every cell and every heading; it can be looked at after any of them.

    Only free cells are poses: the robot's own cell belongs to the body of every probe, so a cell that is occupied or
    unknown explains no reading and its rank stays 0.
    """

    def __init__(self, binary: BinaryMap, headings_rad: Sequence[float], error_radius_cells: float) -> None:
        """Begin with no readings.

        Args:
            binary: the map.
            headings_rad: the headings to try, map frame: one where it is known, else the theta slices.
            error_radius_cells: the paper's eps.
        """
        self.spec = binary.spec
        self.headings_rad = tuple(headings_rad)
        self.readings = 0
        self._error_radius_cells = error_radius_cells
        self._window = _bounds(~binary.occupied)
        # What lies outside the bounds of the free cells is all occupied, as is what lies outside a grid.
        occupied = np.ascontiguousarray(binary.occupied[self._window])
        self._free = ~occupied
        self._obstacles = Obstacles.of(occupied, error_radius_cells)
        self._rank = np.zeros((len(self.headings_rad), *occupied.shape), np.uint16)

    def add(self, reading: RangeReading) -> None:
        """Count one measured reading, hit or miss; O(headings x cells x length of the beam in cells).

        Raises:
            ValueError: the reading measured nothing, or it is the 65536th.
        """
        if self.readings == _READINGS_MAX:
            raise ValueError(f"a rank grid counts {_READINGS_MAX} readings")
        for slice_number, heading_rad in enumerate(self.headings_rad):
            probe = probe_of(
                reading,
                heading_rad,
                resolution_m=self.spec.resolution_m,
                error_radius_cells=self._error_radius_cells,
                reach_cells=2 * max(self._free.shape),
            )
            self._rank[slice_number] += feasible_poses(self._obstacles, probe)
        self.readings += 1

    @property
    def rank(self) -> NDArray[np.uint16]:
        """The count, a new array ``uint16[headings, rows, cols]``."""
        whole = np.zeros((len(self.headings_rad), *self.spec.shape), np.uint16)
        whole[:, *self._window] = self._rank
        return whole

    @property
    def best_rank(self) -> int:
        """The greatest count (the paper's kappa)."""
        return int(self._rank.max(initial=0))

    def cells_of_rank(self, least: int) -> NDArray[np.intp]:
        """Return the poses that explain at least so many readings, ``intp[n, 3]`` as ``(heading, row, col)``, in order.

        Only free cells are poses, even for a rank of 0.
        """
        poses: NDArray[np.intp] = np.argwhere((self._rank >= least) & self._free)
        poses += np.array([0, self._window[0].start, self._window[1].start])
        return poses

    def rank_at(self, poses: NDArray[np.intp]) -> NDArray[np.uint16]:
        """Return the counts ``uint16[n]`` of poses that :meth:`cells_of_rank` returned."""
        heading, row, col = poses.T
        ranks: NDArray[np.uint16] = self._rank[heading, row - self._window[0].start, col - self._window[1].start]
        return ranks

    @property
    def best_cells(self) -> NDArray[np.intp]:
        """The poses of greatest rank (the paper's loc), as :meth:`cells_of_rank`."""
        return self.cells_of_rank(self.best_rank)


def even_headings(count: int) -> tuple[float, ...]:
    """Return theta slices all round, ``2 pi k / count`` ([BrownDonald2000]_ sec. 2.2.3)."""
    return tuple(math.tau * k / count for k in range(count))


def _bounds(cells: NDArray[np.bool_]) -> tuple[slice, slice]:
    """Return the smallest window that holds all set cells; one cell if there are none."""
    rows, cols = np.flatnonzero(cells.any(axis=1)), np.flatnonzero(cells.any(axis=0))
    if rows.size == 0:
        return slice(0, 1), slice(0, 1)
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(cols[0]), int(cols[-1]) + 1)
