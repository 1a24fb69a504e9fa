"""Waiting until the robot stands: before it looks, and at the end of a mission that drove, which is over only then."""

from robotd.core.pose import Odometry
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.stop_and_sweep import standing


async def at_rest(context: MissionContext) -> Odometry:
    """Wait until the robot stands, and return odometry there; after each hold once more.

    What is said of the way counts how it came to rest. And a deadman that ran out in the last moment, as on a busy
    machine, is told of a little later: under way it holds the mission, and afterwards it would be a fault.

    Raises:
        LinkTimeout, DeviceError: odometry stays away, or the base does not come to rest.
    """
    settings = context.settings
    return await context.hold.through(lambda: standing(context.robot, settings.sweep.settle_s, settings.driving))
