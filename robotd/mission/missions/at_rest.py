"""A mission that drove is over when the robot stands, not when its last set-point was sent."""

from robotd.core.pose import Odometry
from robotd.mission.missions.context import MissionContext
from robotd.mission.motion.legs import settle


async def at_rest(context: MissionContext) -> Odometry:
    """Wait until the robot stands, and return odometry there.

    What is said of the way counts how it came to rest. And a deadman that ran out in the last moment, as on a busy
    machine, is told of a little later: under way it holds the mission, and afterwards it would be a fault.

    Raises:
        DeviceError: the base does not come to rest.
    """
    driving, settle_s = context.settings.driving, context.settings.sweep.settle_s
    return await context.hold.through(lambda: settle(context.robot.drive, settle_s, driving))
