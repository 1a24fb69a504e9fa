"""Was the answer right? An estimate, judged by where the log says that the laser was."""

import enum
import math

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2

RIGHT_M = 0.3
RIGHT_RAD = math.radians(5.0)


class CaseVerdict(enum.StrEnum):
    """What became of a case; each has one."""

    RIGHT = "right"
    """Localized, within 0.3 m and 5 degrees."""
    WRONG_AND_SURE = "wrong_and_sure"
    """Localized, and not there."""
    AMBIGUOUS = "ambiguous"
    """Several answers, or one that is no place."""
    LOST = "lost"
    """No answer."""


def verdict_on(estimate: PoseEstimate, truth: Pose2 | None) -> CaseVerdict:
    """Return what became of a case; where there is no truth on the map, to be sure is to be wrong."""
    if estimate.best is not None:
        is_right = truth is not None and is_near(estimate.best, truth)
        return CaseVerdict.RIGHT if is_right else CaseVerdict.WRONG_AND_SURE
    return CaseVerdict.AMBIGUOUS if estimate.state is PoseState.AMBIGUOUS else CaseVerdict.LOST


def has_truth(estimate: PoseEstimate, truth: Pose2 | None) -> bool:
    """Whether the truth is among the answers."""
    if truth is None:
        return False
    return any(region.extent.holds(truth, near_m=RIGHT_M, near_rad=RIGHT_RAD) for region in estimate.regions)


def is_near(pose: Pose2, truth: Pose2) -> bool:
    """Whether a pose is right."""
    turned_rad = abs(wrap_rad(pose.heading_rad - truth.heading_rad))
    return pose.distance_m(truth) <= RIGHT_M and turned_rad <= RIGHT_RAD
