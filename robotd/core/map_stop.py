"""A stop of a map: what was seen there, and where on the map that was."""

from dataclasses import dataclass

from robotd.core.pose import Pose2
from robotd.core.reading import Sweep


@dataclass(frozen=True, slots=True)
class MapStop:
    """A sweep and its place on a map.

    How the head was mounted and tilted is in the readings: each is level, and says where its beam starts.
    """

    sweep: Sweep
    map_from_robot: Pose2
    """Where the robot stood."""
