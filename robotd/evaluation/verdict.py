"""Was the answer right? An estimate, judged by where the log says that the laser was."""

import enum
import math
from dataclasses import dataclass

from robotd.contract.estimate import PoseEstimate, PoseState, Region
from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2
from robotd.evaluation.division import Query

RIGHT_M = 0.3
RIGHT_RAD = math.radians(5.0)


class Verdict(enum.StrEnum):
    """What became of a case; each has one."""

    RIGHT = "right"
    """Localized, within 0.3 m and 5 degrees."""
    WRONG_AND_SURE = "wrong_and_sure"
    """Localized, and not there."""
    AMBIGUOUS = "ambiguous"
    """Several answers, or one that is no place."""
    LOST = "lost"
    """No answer."""


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """One scan, what was said of it, and the truth."""

    query: Query
    estimate: PoseEstimate
    cpu_s: float
    """Processor time of the answer, of all threads."""
    wall_s: float
    """Time until the answer was there."""

    @property
    def truth(self) -> Pose2:
        """Where the laser was."""
        return self.query.scan.laser_pose

    @property
    def verdict(self) -> Verdict:
        """What became of it."""
        best = self.estimate.best
        if best is not None:
            return Verdict.RIGHT if is_near(best, self.truth) else Verdict.WRONG_AND_SURE
        return Verdict.AMBIGUOUS if self.estimate.state is PoseState.AMBIGUOUS else Verdict.LOST

    @property
    def has_truth(self) -> bool:
        """Whether the truth is among the answers."""
        return any(_holds(region, self.truth) for region in self.estimate.regions)

    @property
    def error_m(self) -> float | None:
        """How far the answer is from the truth; None without one answer."""
        best = self.estimate.best
        return None if best is None else best.distance_m(self.truth)

    @property
    def error_rad(self) -> float | None:
        """How far it is turned."""
        best = self.estimate.best
        return None if best is None else abs(wrap_rad(best.heading_rad - self.truth.heading_rad))


def is_near(pose: Pose2, truth: Pose2) -> bool:
    """Whether a pose is right."""
    turned_rad = abs(wrap_rad(pose.heading_rad - truth.heading_rad))
    return pose.distance_m(truth) <= RIGHT_M and turned_rad <= RIGHT_RAD


def _holds(region: Region, truth: Pose2) -> bool:
    """Whether the truth lies in a region, or as near to it as a right answer must."""
    extent = region.extent
    beside_m = max(extent.x_min_m - truth.x_m, truth.x_m - extent.x_max_m, 0.0)
    above_m = max(extent.y_min_m - truth.y_m, truth.y_m - extent.y_max_m, 0.0)
    middle_rad = (extent.heading_min_rad + extent.heading_max_rad) / 2
    turned_rad = abs(wrap_rad(middle_rad - truth.heading_rad)) - (extent.heading_max_rad - middle_rad)
    return math.hypot(beside_m, above_m) <= RIGHT_M and turned_rad <= RIGHT_RAD
