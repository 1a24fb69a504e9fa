"""rnk and loc as the paper says them ([BrownDonald2000]_ sec. 2.2.1), in few lines: the oracle of counting and search.

rnk(M, Z, p) = how many z of Z have p in FP_eps(M, z)
loc(M, Z)    = the poses of greatest rnk
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading
from robotd.grid.pose_set import PoseSet
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.reference.feasible_poses import feasible_poses
from robotd.localization.reference.probe import probe_of


def rank_of(
    obstacles: Obstacles,
    readings: Sequence[RangeReading],
    headings_rad: Sequence[float],
    *,
    resolution_m: float,
    error_radius_cells: float,
) -> NDArray[np.uint16]:
    """Return rnk, ``uint16[headings, rows, cols]``: O(headings x readings x cells x length of a beam).

    Args:
        obstacles: the map, grown by the error radius.
        readings: hits and misses.
        headings_rad: the theta slices, map frame.
        resolution_m: side of one cell.
        error_radius_cells: eps.
    """
    rank = np.zeros((len(headings_rad), *obstacles.free.shape), np.uint16)
    reach_cells = 2 * max(obstacles.free.shape)
    for number, heading_rad in enumerate(headings_rad):
        for reading in readings:
            probe = probe_of(
                reading,
                heading_rad,
                resolution_m=resolution_m,
                error_radius_cells=error_radius_cells,
                reach_cells=reach_cells,
            )
            rank[number] += feasible_poses(obstacles, probe)
    return rank


def loc_of(rank: NDArray[np.uint16], slack: int = 0) -> PoseSet:
    """Return loc, and the poses that explain up to this many readings fewer; none where nothing is explained."""
    best_rank = int(rank.max(initial=0))
    # A pose that explains nothing is no answer, however much slack there is.
    least = max(1, best_rank - slack)
    poses = np.argwhere(rank >= least)
    return PoseSet(poses, rank[tuple(poses.T)], best_rank, least)
