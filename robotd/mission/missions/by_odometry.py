"""One straight, or one turn, as far as the wheels say: needs no map, so it is also how a new base is tried."""

import math

from robotd.contract.events import MissionPhase
from robotd.contract.missions import DriveStraight, Turn
from robotd.core.pose import Odometry
from robotd.mission.missions.at_rest import at_rest
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.motion.legs import TurnedSoFar, next_odometry, translate_to, turn_by


async def run_straight(context: MissionContext, mission: DriveStraight, report: Reporter) -> str:
    """Carry out a :class:`DriveStraight`; return what to tell the client.

    Raises:
        DeviceError, LinkTimeout, TransportError: the base failed on the way.
    """
    driving, drive, hold = context.settings.driving, context.robot.drive, context.hold
    report.at(MissionPhase.DRIVING)
    start = (await hold.through(lambda: next_odometry(drive, driving.silence_s))).in_odom
    goal_m = start.transform(mission.distance_m, 0.0)  # once: after a hold the rest is driven, not all of it again
    is_back = mission.distance_m < 0.0
    await hold.through(lambda: translate_to(drive, *goal_m, driving, hold, backwards=is_back))
    # Told in the frame of the start: who tries a new base holds it against a ruler laid there, not against
    # odometry's origin.
    ahead_m, aside_m = start.inverse().transform(*_place_m(await at_rest(context)))
    return f"drove {ahead_m:.3f} m ahead and {aside_m:.3f} m to the left, by odometry"


async def run_turning(context: MissionContext, mission: Turn, report: Reporter) -> str:
    """Carry out a :class:`Turn`; return what to tell the client. Raises as :func:`run_straight`."""
    driving, drive, hold = context.settings.driving, context.robot.drive, context.hold
    report.at(MissionPhase.DRIVING)
    turned = TurnedSoFar()  # once: a hold does not begin the turn again
    await hold.through(lambda: turn_by(drive, mission.angle_rad, turned, driving, hold))
    turned.note(await at_rest(context))
    return f"turned {math.degrees(turned.rad):.2f} deg, by odometry"


def _place_m(here: Odometry) -> tuple[float, float]:
    return here.in_odom.x_m, here.in_odom.y_m
