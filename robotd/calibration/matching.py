"""Where one sweep was taken, seen from another: heads laid on walls, finer than the cells of a map.

Point-to-line matching (Chen & Medioni 1992; Censi 2008): each head of the one is held against the line through its
nearest heads of the other, by Gauss-Newton steps, and what lies farther off than a gate that narrows has no say. So the
error is that of some hundred readings together, a few millimetres, where a map's cell has fifty (decision 38).

That every range is too long or too short by the same is a fourth unknown beside the pose: walls seen at a slant are
then off, and ways would come out wrong by a hundredth for 50 mm.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotd.calibration.heads import FEWEST_HEADS, SweepHeads
from robotd.core.errors import CalibrationError
from robotd.core.pose import Pose2

_GATES_M = (0.5, 0.3, 0.15, 0.08, 0.08, 0.08)
_SKIPPED = 3
"""Every third head is enough to choose a start by."""
_LOOKED_AT = 3
"""Starts that are followed to their end, of all that are offered."""
_LEAST_SHARE = 0.7
"""Of the heads that come near a wall must lie on it: where rooms are other ones, one in two does by chance."""
_DAMPING = 1e-3
"""Along a corridor nothing holds the pose, and it is to stay where it is."""
_BIAS_WEIGHT = 0.04
"""Of the belief that there is no bias, against that of one reading: errors of 20 mm against a bias of 100."""
_NO_BIAS = 1e9
_TIES = 4.0
"""By this factor variances grow because the lines share their heads, and have errors of their own; from simulated
rooms (``tests/unit/calibration/test_matching.py``)."""


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """Two sweeps laid on each other."""

    pose: Pose2
    """``reference_from_moved``."""
    covariance: NDArray[np.float64]
    """``float64[3, 3]`` of x, y [m] and heading [rad]."""
    bias_m: float
    """What must be added to the ranges of both for their walls to agree; a hint, good to a few centimetres."""
    residuals_m: NDArray[np.float64]
    """``float64[k]``: how far the heads that lie on walls lie from them."""
    share: float
    """Of the heads that come near walls, how many lie on them."""


def match(reference: SweepHeads, moved: SweepHeads, starts: Sequence[Pose2], *, at_one_place: bool = False) -> Match:
    """Return where ``moved`` was taken in the frame of ``reference``, begun from the best of some starts.

    From two sweeps ``at_one_place`` no bias can be told, and none is sought.

    Raises:
        CalibrationError: from none of them the two sweeps show the same walls.
    """
    # From one place a bias moves all walls alike, in both sweeps, and nothing could tell it.
    bias_weight = _NO_BIAS if at_one_place else _BIAS_WEIGHT
    first = np.array([(start.x_m, start.y_m, start.heading_rad) for start in starts], np.float64)
    order = np.argsort([_misfit(reference, moved, pose) for pose in first])
    # A few are followed to the end and not the best start alone: in a square room a quarter turn fits nearly as
    # well at first.
    best = min(
        (_descend(reference, moved, pose, bias_weight) for pose in first[order[:_LOOKED_AT]]),
        key=lambda unknown: _misfit(reference, moved, unknown[:3]),
    )
    return _judged(reference, moved, best, bias_weight)


def _laid(at_m: NDArray[np.float64], pose: NDArray[np.float64]) -> NDArray[np.float64]:
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    laid: NDArray[np.float64] = at_m @ np.array(((cos, sin), (-sin, cos))) + pose[:2]
    return laid


def _nearest(reference: SweepHeads, laid: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    # The squares of the distances, less that of each of ``laid``: which is nearest does not depend on it.
    nearest = ((reference.at_m**2).sum(axis=1) - 2.0 * laid @ reference.at_m.T).argmin(axis=1)
    return nearest, np.linalg.norm(laid - reference.at_m[nearest], axis=1)


def _misfit(reference: SweepHeads, moved: SweepHeads, pose: NDArray[np.float64]) -> float:
    """Return how badly a pose fits: mean distance of the heads, of which none counts for more than the widest gate."""
    _, apart_m = _nearest(reference, _laid(moved.at_m[::_SKIPPED], pose))
    return float(np.minimum(apart_m, _GATES_M[0]).mean())


def _descend(
    reference: SweepHeads, moved: SweepHeads, pose: NDArray[np.float64], bias_weight: float
) -> NDArray[np.float64]:
    """Return x, y, heading and bias that fit best near a pose."""
    unknown = np.array((*pose, 0.0))
    # Wide at first, so that a start half a metre off finds its walls; narrow at last, so that a chair has no
    # say.
    for gate_m in _GATES_M:
        jacobian, off_m = _system(reference, moved, unknown, gate_m)
        if len(off_m) < FEWEST_HEADS:
            return unknown
        pull = np.array((0.0, 0.0, 0.0, bias_weight * unknown[3]))
        normal = jacobian.T @ jacobian + np.diag((_DAMPING, _DAMPING, _DAMPING, bias_weight))
        unknown = unknown - np.linalg.solve(normal, jacobian.T @ off_m + pull)
    return unknown


def _system(
    reference: SweepHeads, moved: SweepHeads, unknown: NDArray[np.float64], gate_m: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the distances from the walls within the gate, and how they change with the unknown: ``float64[k, 4]``.

    Both ways round: the heads of each sweep against the walls of the other.
    """
    x_y_m, (heading_rad, bias_m) = unknown[:2], unknown[2:]
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
    turn = np.array(((cos, -sin), (sin, cos)))

    arm, ahead = moved.at_m @ turn.T, moved.ahead @ turn.T
    there, off_there_m = _held_against(reference, arm + x_y_m, ahead, bias_m=bias_m, gate_m=gate_m)
    normal = reference.normal[there.walls]
    lengthens = (normal * (ahead[there.heads] - reference.ahead[there.walls])).sum(axis=1)
    forth = np.column_stack((normal, _across(arm[there.heads], normal), lengthens))

    back, ahead = (reference.at_m - x_y_m) @ turn, reference.ahead @ turn
    here, off_here_m = _held_against(moved, back, ahead, bias_m=bias_m, gate_m=gate_m)
    normal = moved.normal[here.walls]
    lengthens = (normal * (ahead[here.heads] - moved.ahead[here.walls])).sum(axis=1)
    home = np.column_stack((-normal @ turn.T, -_across(back[here.heads], normal), lengthens))
    # Both ways round: a wall that only one of them saw well would else pull with one side's errors alone.
    return np.vstack((forth, home)), np.concatenate((off_there_m, off_here_m))


def _across(arm: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how fast the ends of arms move along normals as they turn counter-clockwise."""
    across: NDArray[np.float64] = arm[:, 0] * normal[:, 1] - arm[:, 1] * normal[:, 0]
    return across


class _Pairs(NamedTuple):
    heads: NDArray[np.intp]
    walls: NDArray[np.intp]


def _held_against(
    walls: SweepHeads, laid: NDArray[np.float64], ahead: NDArray[np.float64], *, bias_m: float, gate_m: float
) -> tuple[_Pairs, NDArray[np.float64]]:
    """Return which heads lie on which walls, and how far off; what lies off farther than the gate is left out."""
    nearest, apart_m = _nearest(walls, laid)
    longer = bias_m * (ahead - walls.ahead[nearest])
    off_m = ((laid - walls.foot_m[nearest] + longer) * walls.normal[nearest]).sum(axis=1)
    used = np.flatnonzero(walls.is_wall[nearest] & (apart_m <= 2.0 * gate_m) & (np.abs(off_m) <= gate_m))
    return _Pairs(used, nearest[used]), off_m[used]


def _judged(reference: SweepHeads, moved: SweepHeads, unknown: NDArray[np.float64], bias_weight: float) -> Match:
    jacobian, off_m = _system(reference, moved, unknown, _GATES_M[-1])
    _, near_m = _system(reference, moved, unknown, _GATES_M[0])
    share = len(off_m) / max(1, len(near_m))
    # An error and not a doubtful match: a constant that is wrong is worse than one that was not measured.
    if share < _LEAST_SHARE or len(off_m) < FEWEST_HEADS:
        raise CalibrationError(
            f"the two sweeps do not show the same walls: {share:.0%} of {len(near_m)} readings near them agree;"
            " try where more walls are near, and nobody moves"
        )
    variance = float((off_m**2).mean())
    normal = jacobian.T @ jacobian + np.diag((1e-9, 1e-9, 1e-9, bias_weight))
    covariance = np.asarray(_TIES * variance * np.linalg.inv(normal), np.float64)[:3, :3]
    x_m, y_m, heading_rad, bias_m = unknown.tolist()
    return Match(Pose2(x_m, y_m, math.remainder(heading_rad, math.tau)), covariance, bias_m, off_m, share)
