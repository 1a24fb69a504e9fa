"""Carry the pose forward by odometry, and say so: the state is ``predicted``."""

import math
from dataclasses import dataclass

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.angles import wrap_rad
from robotd.core.pose import Odometry, Pose2
from robotd.mission.whereabouts.map_in_use import MapInUse

_MOVED_M = 0.02
_TURNED_RAD = 0.02


def unlocalized(time_ns: int, map_id: str) -> PoseEstimate:
    """Return the estimate of a robot that does not know where it is: said at once, never by silence."""
    return PoseEstimate(time_ns, PoseState.LOST, None, (), 0, 0, True, map_id)


@dataclass(slots=True)
class Predictor:
    """Decides when odometry has moved far enough from what was last said."""

    said: Pose2 | None = None

    def predict(self, odometry: Odometry, place: MapInUse) -> PoseEstimate | None:
        """Return a new estimate if the robot has moved since the last, else None."""
        pose = place.pose_of(odometry)
        if pose is None or not self._has_moved(pose):
            return None
        self.said = pose
        return PoseEstimate(odometry.time_ns, PoseState.PREDICTED, pose, (), 0, 0, True, place.map_id)

    def _has_moved(self, pose: Pose2) -> bool:
        if self.said is None:
            return True
        turned_rad = wrap_rad(pose.heading_rad - self.said.heading_rad)
        return (
            math.hypot(pose.x_m - self.said.x_m, pose.y_m - self.said.y_m) > _MOVED_M or abs(turned_rad) > _TURNED_RAD
        )
