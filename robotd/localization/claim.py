"""What may be claimed: lost, ambiguous, localized."""

import numpy as np

from robotd.contract.estimate import PoseState
from robotd.grid.pose_set import PoseSet
from robotd.localization.places.pieces import pieces_of

_UNIQUE_M = 1.0
"""In the conservative mode, a region that is longer is no one place."""


def state_by_belief(found: PoseSet, believed: PoseState) -> PoseState:
    """Return what the second look believes, unless it could not look at all poses."""
    # Poses too many to tell were never looked at, and the right one may be among them.
    return believed if found.is_all else PoseState.AMBIGUOUS


def state_by_proof(found: PoseSet, headings_rad: tuple[float, ...], resolution_m: float) -> PoseState:
    """Return what the conservative mode may claim, where belief excludes nothing and only proof does.

    Args:
        found: all poses that cannot be excluded.
        headings_rad: those that were tried.
        resolution_m: side of one cell.
    """
    if not found.is_all:
        return PoseState.AMBIGUOUS
    # Asked only now: a set too large to tell holds no poses either, and would pass for lost.
    if len(found) == 0:
        return PoseState.LOST
    return PoseState.LOCALIZED if _is_one_place(found, headings_rad, resolution_m) else PoseState.AMBIGUOUS


def _is_one_place(found: PoseSet, headings_rad: tuple[float, ...], resolution_m: float) -> bool:
    """Whether poses are all connected, and no corridor or room full of them."""
    # One region is asked for: it does not matter which, only whether any is left out.
    is_connected = pieces_of(found, headings_rad, 1).left_out == 0
    return is_connected and float(np.hypot(*np.ptp(found.poses[:, 1:], axis=0))) <= _UNIQUE_M / resolution_m
