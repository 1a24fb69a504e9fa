"""Poses of high rank: the one form in which counting, searching and the conservative mode answer."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec


@dataclass(frozen=True, slots=True, eq=False)
class PoseSet:
    """Cells at headings, and how many readings each explains: the paper's loc, and what comes near it."""

    poses: NDArray[np.intp]
    """``intp[n, 3]``, ``(heading, row, col)``, ascending and each once."""
    ranks: NDArray[np.uint16]
    """``uint16[n]``: how many readings each explains."""
    best_rank: int
    """The greatest rank there is (the paper's kappa), even if there are too many poses to tell; 0 if it is less than
    what was asked for: that is sooner known than how great it is."""
    least_rank: int = 1
    """Every pose of at least this rank is here, and no other."""
    is_all: bool = True
    """Whether these are all that were asked for; there may be more than can be told."""

    @classmethod
    def nothing(cls, least_rank: int = 1) -> "PoseSet":
        """Return what is found where no pose explains as many readings as were asked for."""
        return cls(np.zeros((0, 3), np.intp), np.zeros(0, np.uint16), 0, least_rank)

    @classmethod
    def of_rows(
        cls, rows: NDArray[np.int32], best_rank: int, least_rank: int, *, slack: int, is_complete: bool = True
    ) -> "PoseSet":
        """Take what a kernel found.

        Args:
            rows: ``int32[n, 4]``, ``(heading, row, col, rank)``, ascending.
            best_rank: the greatest rank; 0 if it is less than what was asked for.
            least_rank: of all that are here.
            slack: poses were asked for that explain up to this many readings fewer than the best.
            is_complete: whether it looked at all there is.
        """
        # A kernel that finds too many raises the least rank: then some that were asked for are missing.
        is_all = is_complete and (least_rank <= max(1, best_rank - slack) or best_rank == 0)
        return cls(rows[:, :3].astype(np.intp), rows[:, 3].astype(np.uint16), best_rank, least_rank, is_all)

    def __len__(self) -> int:
        """Return how many poses there are."""
        return len(self.poses)

    @property
    def best(self) -> NDArray[np.intp]:
        """Those of greatest rank among them, ``intp[k, 3]``; there must be one."""
        best: NDArray[np.intp] = self.poses[self.ranks == self.ranks.max()]
        return best

    def part(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> "PoseSet":
        """Return some of them, by ascending indices or by a mask, and the greatest rank of these."""
        ranks = self.ranks[which]
        return PoseSet(self.poses[which], ranks, int(ranks.max(initial=0)), self.least_rank, self.is_all)

    def holds(self, pose: NDArray[np.intp]) -> bool:
        """Return whether a pose ``(heading, row, col)`` is one of them."""
        return bool((self.poses == pose).all(axis=1).any())

    def holds_cell(self, row: int, col: int) -> bool:
        """Return whether the robot is in this cell in one of them, at any heading."""
        return bool(((self.poses[:, 1] == row) & (self.poses[:, 2] == col)).any())

    def in_metres(self, spec: GridSpec, headings_rad: Sequence[float]) -> NDArray[np.float64]:
        """Return them as x, y [m] and heading [rad] in the map frame, ``float64[n, 3]``.

        Args:
            spec: where the cells lie.
            headings_rad: what the headings are.
        """
        cells = self.poses[:, 1:] + 0.5
        x_m, y_m = spec.origin_x_m + cells[:, 1] * spec.resolution_m, spec.origin_y_m + cells[:, 0] * spec.resolution_m
        return np.stack((x_m, y_m, np.array(headings_rad)[self.poses[:, 0]]), axis=1)

    def cells(self) -> NDArray[np.intp]:
        """Return their cells ``(row, col)``, ``intp[k, 2]``, ascending and each once."""
        cols = int(self.poses[:, 2].max(initial=0)) + 1
        # As single integers, which NumPy sorts sooner than rows.
        flat = np.unique(self.poses[:, 1] * cols + self.poses[:, 2])
        return np.stack((flat // cols, flat % cols), axis=1)
