"""How the odometry frame lies on the map, and whether that is still believed."""

from dataclasses import dataclass, replace

from robotd.core.pose import Pose2


@dataclass(frozen=True, slots=True)
class Tie:
    """One moment at which the robot's place on the map and in odometry were both known; odometry carries it on."""

    map_from_odom: Pose2
    is_doubted: bool = False
    """Whether it is no longer believed: a robot that looked and did not find itself, or was out of sight of its wheels,
    does not know where it is. It may still know which way it looks, so a doubted tie is kept, not dropped."""

    @classmethod
    def between(cls, map_from_robot: Pose2, in_odom: Pose2) -> "Tie":
        """Return the tie of a robot that was at ``map_from_robot`` when odometry placed it at ``in_odom``."""
        return cls(map_from_robot @ in_odom.inverse())

    def doubted(self) -> "Tie":
        """Return it as one that is not believed."""
        return replace(self, is_doubted=True)

    def in_map(self, in_odom: Pose2) -> Pose2:
        """Return where a pose in the odometry frame lies on the map, believed or not."""
        return self.map_from_odom @ in_odom
