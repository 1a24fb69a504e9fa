"""Sweeps in the simulated rooms, without a robot: what a perfect head and a noisy laser see."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.calibration.heads import SweepHeads
from robotd.core.pose import Pose2
from robotd.sim.buildings.world import World
from robotd.sim.physics.walls import ray_cast

REACH_M = 6.0
OUTLIERS = 0.05


@dataclass(frozen=True)
class Seen:
    bearings_rad: NDArray[np.float64]
    ranges_m: NDArray[np.float64]

    def heads(self, turned_rad: float = 0.0) -> SweepHeads:
        """As a head sees it whose zero is turned so far."""
        return SweepHeads.of(self.bearings_rad + turned_rad, self.ranges_m, np.zeros((len(self.ranges_m), 2)))


def seen_from(
    world: World, pose: Pose2, rng: np.random.Generator, *, sigma_m: float = 0.02, bias_m: float = 0.0
) -> Seen:
    """What 262 readings over 314 degrees see, one in twenty of them wrong."""
    bearings_rad = np.linspace(-2.74, 2.74, 262)
    ranges_m = np.array(
        [
            ray_cast(world.walls, (pose.x_m, pose.y_m), pose.heading_rad + bearing, eye_height_m=0.3, climb=0.0)
            for bearing in bearings_rad
        ]
    )
    ranges_m += bias_m + rng.normal(0.0, sigma_m, len(ranges_m)) if sigma_m else bias_m
    wrong = rng.random(len(ranges_m)) < (OUTLIERS if sigma_m else 0.0)
    ranges_m = np.where(wrong, rng.uniform(0.3, REACH_M, len(ranges_m)), ranges_m)
    met = ranges_m < REACH_M
    return Seen(bearings_rad[met], ranges_m[met])
