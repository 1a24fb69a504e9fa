"""From many poses of high rank to a few starting points, one for each place they stand for.

Poses that touch explain much the same readings, and a second look moves each start uphill anyway: of the poses within
reach of each other only the best one is kept.
"""

import math

import numpy as np
from numpy.typing import NDArray


def shortlist(
    poses: NDArray[np.float64], ranks: NDArray[np.integer], reach_m: float, reach_rad: float, most: int
) -> NDArray[np.intp]:
    """Return which poses to start from, ``intp[k]``, best rank first, of equal ones the first.

    Every pose lies within reach of a start that explains as many readings or more, unless ``most`` starts were found
    before: then those that explain fewest are left out.

    Args:
        poses: ``float64[n, 3]``: x, y [m] and heading [rad].
        ranks: ``[n]``, readings explained.
        reach_m: how near poses stand for each other, in the plane ...
        reach_rad: ... and in heading.
        most: how many starts are wanted.

    O(n log n + most x n).
    """
    # Signed before the sign is turned: ranks come as unsigned numbers. Stable, for replays.
    left = np.argsort(-ranks.astype(np.int64), kind="stable")
    starts: list[int] = []
    while len(left) and len(starts) < most:
        start = poses[left[0]]
        starts.append(int(left[0]))
        # Only what lies in the same strip of the map can be near: of a building's poses that is one in a hundred.
        beside = np.flatnonzero(np.abs(poses[left, 0] - start[0]) <= reach_m)
        left = np.delete(left, beside[near(poses[left[beside]], start, reach_m, reach_rad)])
    return np.array(starts, np.intp)


def near(poses: NDArray[np.float64], pose: NDArray[np.float64], reach_m: float, reach_rad: float) -> NDArray[np.bool_]:
    """Return which of ``float64[n, 3]`` lie within reach of a pose ``float64[3]``, its edge included."""
    off = poses - pose
    turned = np.abs((off[:, 2] + math.pi) % math.tau - math.pi)
    within: NDArray[np.bool_] = (np.hypot(off[:, 0], off[:, 1]) <= reach_m) & (turned <= reach_rad)
    return within
