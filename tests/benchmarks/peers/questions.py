"""The questions that all are asked: the room of workload S, random poses in it, a sweep from each, and priors."""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.core.reading import Sweep
from robotd.grid.readings import Readings
from tests.benchmarks import workload

POSES = 100
STOPS = 12
PRIOR_M, PRIOR_RAD = 0.3, math.radians(10.0)


class Questions:
    """Everything seeded."""

    def __init__(self) -> None:
        random = np.random.default_rng(0)
        self.occupied = workload.room()
        self.poses = workload.poses_in(self.occupied, POSES)
        self.sweeps = [workload.sweep_of(self.occupied, seed, pose) for seed, pose in enumerate(self.poses)]
        self.priors = [_off(pose, random) for pose in self.poses]
        self.stops = workload.poses_in(self.occupied, STOPS, seed=5)
        """Where peers that want sweeps instead of a map have theirs from."""

    def save(self, file: Path) -> None:
        """Write them as plain arrays, for a program that knows nothing of us.

        ``occupied: bool[rows, cols]``; ``poses, priors: float64[n, 3]``; ``ranges: float64[n, 300]``, the cut-off where
        nothing was met, bearings evenly from 0; ``stops: float64[k, 3]``, ``stop_ranges: float64[k, 300]``, exact.
        """
        np.savez(
            file,
            occupied=self.occupied,
            poses=_rows(self.poses),
            priors=_rows(self.priors),
            ranges=np.array([_ranges(sweep) for sweep in self.sweeps]),
            stops=_rows(self.stops),
            stop_ranges=np.array([workload.ranges_from(self.occupied, stop) for stop in self.stops]),
            resolution_m=workload.RESOLUTION_M,
            cut_off_m=workload.CUT_OFF_M,
        )


def _off(pose: Pose2, random: np.random.Generator) -> Pose2:
    x, y, turn = random.uniform(-1.0, 1.0, 3).tolist()
    return Pose2(pose.x_m + PRIOR_M * x, pose.y_m + PRIOR_M * y, pose.heading_rad + PRIOR_RAD * turn)


def _rows(poses: list[Pose2]) -> NDArray[np.float64]:
    return np.array([(pose.x_m, pose.y_m, pose.heading_rad) for pose in poses])


def _ranges(sweep: Sweep) -> NDArray[np.float64]:
    ranges_m: NDArray[np.float64] = Readings.of(sweep.readings).range_m
    return ranges_m
