"""What a client can ask the robot to do."""

import enum
from dataclasses import dataclass

from robotd.contract.area import Area
from robotd.core.pose import IDENTITY, Pose2


class Legs(enum.StrEnum):
    """How to get from one stop to the next."""

    PLANNED = "planned"
    """Round the obstacles on the map so far."""
    STRAIGHT = "straight"
    """In a straight line, as somebody knows it to be free."""


@dataclass(frozen=True, slots=True)
class MapMission:
    """Make a new map, stop by stop."""

    name: str
    stops_m: tuple[tuple[float, float], ...]
    """Where to stop after the start, ``(x, y)`` in the map frame. The start is always the first stop."""
    start: Pose2 = IDENTITY
    """Where the robot stands now: it defines the map frame."""
    legs: Legs = Legs.PLANNED


class PriorHeading(enum.StrEnum):
    """What is known of the robot's heading before it looks round."""

    ODOMETRY = "odometry"
    """What odometry says, give or take the setting ``heading_error_rad``."""
    UNKNOWN = "unknown"
    """Nothing: all headings are tried."""


@dataclass(frozen=True, slots=True)
class LocalizeMission:
    """Sweep at the present stop and say where it is on the map in use."""

    heading_rad: float | None = None
    """The robot's heading in the map frame, if the client knows better than odometry."""
    tie: bool = True
    """Whether odometry is tied anew to the map where the robot is found; otherwise it is only said."""
    heading: PriorHeading = PriorHeading.ODOMETRY
    within: Area | None = None
    """Where on the map it is, if the client knows; no other place is then an answer."""

    def __post_init__(self) -> None:
        """Refuse a heading that is known and unknown."""
        if self.heading is PriorHeading.UNKNOWN and self.heading_rad is not None:
            raise ValueError("heading_rad cannot be given where the heading is unknown")


@dataclass(frozen=True, slots=True)
class DriveMission:
    """Drive to a place on the map in use."""

    x_m: float
    y_m: float
    legs: Legs = Legs.PLANNED


Mission = MapMission | LocalizeMission | DriveMission
