"""Uphill to the pose of greatest likelihood, from many poses at once.

A likelihood by cells has no slope to follow, so neighbouring poses are tried: forward, sideways and turned, in steps
that are halved when none is better.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.localization.judge.likelihood import Likelihood, Sight

_NEIGHBOURS = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float64)
_BETTER = 1e-3
"""A step must gain this much."""


@dataclass(frozen=True, slots=True, eq=False)
class Hill:
    """How likely readings are, by poses."""

    likelihood: Likelihood
    sight: Sight
    """``m`` readings."""
    weights: NDArray[np.float64]
    """``float64[m]``, how much each has to say."""

    def heights(self, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the weighted sum of the logarithms of the likelihoods at poses ``float64[n, 3]``, ``float64[n]``."""
        heights: NDArray[np.float64] = (self.likelihood.logs(self.sight, poses) * self.weights).sum(axis=1)
        return heights


def climb(
    hill: Hill, poses: NDArray[np.float64], steps: tuple[tuple[float, float], ...], moves_max: int = 12
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return better poses near to others, and their heights.

    Args:
        hill: what to climb.
        poses: ``float64[n, 3]``: x, y [m], heading [rad].
        steps: sizes of step, ``(m, rad)``, from coarse to fine.
        moves_max: how many steps of one size are made at most.

    Returns:
        Poses ``float64[n, 3]`` and heights ``float64[n]``.
    """
    poses = poses.copy()
    heights = hill.heights(poses)
    for step_m, step_rad in steps:
        # Along the axes of the map: the heights know of no better direction, and six neighbours are cheap to
        # try at once.
        around = _NEIGHBOURS * np.array([step_m, step_m, step_rad])
        moving = np.arange(len(poses))
        for _ in range(moves_max):
            if len(moving) == 0:
                break
            tried = poses[moving, None] + around
            tried_heights = hill.heights(tried.reshape(-1, 3)).reshape(len(moving), -1)
            which = tried_heights.argmax(axis=1)
            highest = tried_heights[np.arange(len(moving)), which]
            better = highest > heights[moving] + _BETTER
            moved = moving[better]
            poses[moved], heights[moved] = tried[better, which[better]], highest[better]
            # A pose that finds nothing better rests until the steps become finer: trying it again would find the same.
            moving = moved
    return poses, heights
