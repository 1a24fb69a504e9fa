"""Regions, each with the belief that the second look has in what lies in it: counting and judging brought together."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.pose_set import PoseSet
from robotd.localization.judge.second_look import SecondLook
from robotd.localization.places.pieces import pieces_of

_ALIKE_M, _ALIKE_RAD = 0.1, 0.03
"""To be this far to one side, or turned by this much, is as far from a place."""


@dataclass(frozen=True, slots=True, eq=False)
class JudgedRegion:
    """One region, and what the second look says of it."""

    piece: PoseSet
    belief: float = 0.0
    begin: Pose2 | None = None
    """The best place in or near to it, if the second look took it into consideration."""


def judged_regions(
    found: PoseSet, poses_m: NDArray[np.float64], look: SecondLook, headings_rad: tuple[float, ...], most: int
) -> tuple[tuple[JudgedRegion, ...], int]:
    """Return the regions that the poses form, those of the best places first, and how many more there are.

    Args:
        found: the poses of high rank, at least one.
        poses_m: the same as x, y [m] and heading [rad], ``float64[n, 3]``.
        look: what the second look says of them.
        headings_rad: those that were tried.
        most: how many regions to return.
    """
    # A place that climbed may lie in no region at all; the nearest pose is the one that it climbed from, or
    # beside it.
    nearest = np.array([_nearest(poses_m, place) for place in look.poses], np.intp)
    # Regions of places that were looked at come first: rank is a good shortlist and a poor judge (decision 16).
    pieces = pieces_of(found, headings_rad, most, nearest)
    regions = [JudgedRegion(piece) for piece in pieces.best]
    for place, number, belief in zip(look.poses, nearest, look.beliefs, strict=True):
        _give(regions, found.poses[number], Pose2(*place.tolist()), float(belief))
    return tuple(regions), pieces.left_out


def _nearest(poses_m: NDArray[np.float64], place: NDArray[np.float64]) -> int:
    """Return which of the poses a place is nearest to."""
    off = poses_m - place
    turned_rad = (off[:, 2] + math.pi) % math.tau - math.pi
    return int(np.hypot(np.hypot(off[:, 0], off[:, 1]) / _ALIKE_M, turned_rad / _ALIKE_RAD).argmin())


def _give(regions: list[JudgedRegion], pose: NDArray[np.intp], place: Pose2, belief: float) -> None:
    """Give the region that holds a pose the belief in the place it is nearest to; the first to come is the best."""
    # If the list is too short for the region of a place, no region is given its belief.
    for number, region in enumerate(regions):
        if region.piece.holds(pose):
            regions[number] = JudgedRegion(region.piece, region.belief + belief, region.begin or place)
            return
