"""Where a sweep may have been taken as well: the ridge on which walls do not hold a pose.

Refinement tells how sure a pose is by the slopes of the walls' distances there. Along a straight wall these slopes are
those of its cells, of gaps between them, and of its end on a young map: they mean nothing, and claim centimetres where
any place along the wall does as well. So poses all over the box are asked what speaks against them, and what the sweep
says is their mean and their scatter, each by how likely it is (Olson, *Real-Time Correlative Scan Matching*, 2009).
What ends where nobody has looked does not speak against a pose, and what a wall explains not for it: else each sweep
would slide back along the wall to where the map is.
"""

import math

import numpy as np
from numpy.typing import NDArray

from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.fit.agreement import agreements
from robotd.localization.fit.refinement import PoseBox, refine
from robotd.localization.fit.refinement_settings import RefinementSettings

_STEP_M = 0.1
_STEPS_MAX = 5
"""To each side; where the box is wide, steps are longer."""
_AGAINST = 0.5
"""What a hit says against a pose where the map contradicts it, natural logarithm: some two, but neighbours err
together, and of some four of them only one says something of its own."""


def ridge_of(
    walls: WallField,
    vacant: NDArray[np.bool_],
    readings: Readings,
    box: PoseBox,
    refinement: RefinementSettings,
) -> tuple[Pose2, NDArray[np.float64]]:
    """Return the mean and the scatter ``float64[3, 3]`` of the poses in a box that explain a sweep.

    Args:
        walls: of the map; walls alone block.
        vacant: ``bool[rows, cols]``: the cells that were seen, and seen vacant.
        readings: hits and misses; misses have no say.
        box: where to look; as wide along x as along y, and with a heading that is known well.
        refinement: how poses are refined.

    O(poses x readings), at most 121 poses.
    """
    hits = readings[readings.is_hit]
    poses = refine(walls, hits, _starts(box), refinement).poses
    against = _AGAINST * agreements(walls, vacant, hits, poses)[1].sum(axis=1)
    shares = np.exp(against.min() - against)
    shares /= shares.sum()
    # Headings were not wrapped, so that they can be averaged as numbers.
    mean = shares @ poses
    off = poses - mean
    x_m, y_m, heading_rad = mean.tolist()
    return Pose2(x_m, y_m, wrap_rad(heading_rad)), off.T @ (off * shares[:, None])


def _starts(box: PoseBox) -> list[PoseBox]:
    """Return the box with its start in many places, evenly all over it."""
    bounds, start = box.bounds, box.start
    half_m = (bounds.x_max_m - bounds.x_min_m) / 2.0
    places = np.linspace(-half_m, half_m, 2 * min(_STEPS_MAX, math.ceil(half_m / _STEP_M)) + 1).tolist()
    return [
        PoseBox(Pose2(start.x_m + x_m, start.y_m + y_m, start.heading_rad), bounds) for y_m in places for x_m in places
    ]
