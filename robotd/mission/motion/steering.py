"""Control laws of the synchro-drive: pure functions from where it is to how fast it should go."""

import math
from dataclasses import dataclass
from typing import Annotated

from robotd.core.angles import wrap_rad
from robotd.core.bounds import Within, refuse_outside
from robotd.core.pose import Pose2, Twist2

_STEER_WITHIN_M = 0.10  # nearer than this the bearing to the goal says nothing about the heading


@dataclass(frozen=True, slots=True)
class DrivingSettings:
    """How the base drives its legs."""

    speed_mps: Annotated[float, Within(0.01, 5.0, "m/s")] = 0.4
    """Cruising speed."""
    turn_radps: Annotated[float, Within(0.01, 10.0, "rad/s")] = 1.0
    """Turning speed."""
    deceleration_mps2: Annotated[float, Within(0.01, 10.0, "m/s^2")] = 0.3
    """How hard it plans to brake; well below what the base can."""
    turn_deceleration_radps2: Annotated[float, Within(0.01, 50.0, "rad/s^2")] = 1.0
    """The same for turning."""
    gain_hz: Annotated[float, Within(0.1, 50.0, "Hz")] = 5.0
    """Speed per remaining distance at the very end of a leg."""
    position_tolerance_m: Annotated[float, Within(0.001, 0.5, "m")] = 0.02
    """A leg ends this near to its end."""
    heading_tolerance_rad: Annotated[float, Within(0.001, 0.5, "rad")] = 0.01
    """A turn ends this near to its heading."""
    setpoint_ttl_s: Annotated[float, Within(0.01, 5.0, "s")] = 0.4
    """How long the base may follow one set-point without hearing another."""
    silence_s: Annotated[float, Within(0.01, 10.0, "s")] = 0.5
    """Odometry silent for so long means stop."""
    stall_s: Annotated[float, Within(0.1, 60.0, "s")] = 3.0
    """No nearer to the goal, or to standstill, for so long means that something is wrong."""

    def __post_init__(self) -> None:
        """Refuse what cannot be driven."""
        refuse_outside(self)


def turn_rate_radps(error_rad: float, settings: DrivingSettings) -> float:
    """Return how fast to turn with ``error_rad`` still to go; fades out towards the goal."""
    # The root is braking at constant deceleration, v^2 = 2 a s. Its slope has no end at the goal, so the last piece is
    # proportional to what is left.
    remaining = abs(error_rad)
    rate = min(
        settings.turn_radps,
        math.sqrt(2.0 * settings.turn_deceleration_radps2 * remaining),
        settings.gain_hz * remaining,
    )
    return math.copysign(rate, error_rad)


def distance_left_m(here: Pose2, goal_x_m: float, goal_y_m: float) -> float:
    """Return how far the goal lies ahead along the heading; negative once it is passed."""
    return (goal_x_m - here.x_m) * math.cos(here.heading_rad) + (goal_y_m - here.y_m) * math.sin(here.heading_rad)


def leg_twist(here: Pose2, goal_x_m: float, goal_y_m: float, settings: DrivingSettings) -> Twist2:
    """Return the velocity that follows a straight leg to its end, steering while there is room to."""
    left_m = max(0.0, distance_left_m(here, goal_x_m, goal_y_m))
    speed_mps = min(
        settings.speed_mps,
        math.sqrt(2.0 * settings.deceleration_mps2 * left_m),
        settings.gain_hz * left_m,
    )
    # Straight on for the last piece: a few millimetres beside the goal would be a right angle of bearing.
    if left_m < _STEER_WITHIN_M:
        return Twist2(speed_mps, 0.0)
    bearing_rad = math.atan2(goal_y_m - here.y_m, goal_x_m - here.x_m)
    return Twist2(speed_mps, turn_rate_radps(wrap_rad(bearing_rad - here.heading_rad), settings))
