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
    further: tuple["Hill", ...] = ()
    """What other layers of the map say of the readings at their tilts: evidence adds up."""

    def logs(self, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the weighted logarithms of the likelihoods at poses ``float64[n, 3]``, ``float64[n, readings]``.

        Those of its own readings come first, then those of each further layer.
        """
        own: NDArray[np.float64] = self.likelihood.logs(self.sight, poses) * self.weights
        return np.concatenate((own, *(hill.logs(poses) for hill in self.further)), axis=1) if self.further else own

    def heights(self, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the sum of all that is said at poses ``float64[n, 3]``, ``float64[n]``."""
        heights: NDArray[np.float64] = self.logs(poses).sum(axis=1)
        return heights

    @property
    def elsewhere(self) -> NDArray[np.float64]:
        """What :meth:`logs` are of a robot that is not on the map, ``float64[readings]``."""
        own: NDArray[np.float64] = self.likelihood.elsewhere_logs(self.sight) * self.weights
        return np.concatenate((own, *(hill.elsewhere for hill in self.further))) if self.further else own

    @property
    def all_say(self) -> float:
        """How many things all readings say."""
        return float(self.weights.sum()) + sum(hill.all_say for hill in self.further)

    @property
    def hits_say(self) -> float:
        """How many things the hits say."""
        return float(self.weights[self.sight.is_hit].sum()) + sum(hill.hits_say for hill in self.further)


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
