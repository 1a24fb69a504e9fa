"""A head that met a stop does not know where it points: it is reset, and the sweep is taken again, all of it."""

from collections.abc import Awaitable, Callable
from typing import TypeVar

from robotd.contract.events import MissionPhase
from robotd.core.errors import DeviceError
from robotd.hardware.devices.pantilt import LOST_STEPS
from robotd.mission.missions.context import MissionContext, Reporter

T = TypeVar("T")


async def looking_again(context: MissionContext, report: Reporter, look: Callable[[], Awaitable[T]]) -> T:
    """Return what came of a look round; after lost steps, reset the head and look again, as often as is set.

    What was read before the steps were lost is thrown away: it is not known since when the head pointed elsewhere.

    Raises:
        DeviceError: as ``look`` does, and of code ``lost_steps`` when it was tried often enough.
    """
    resets = context.settings.sweep.resets
    for number in range(1, resets + 1):
        try:
            return await look()
        except DeviceError as error:
            # Only lost steps are mended by a reset: what else a head reports would be reported again.
            if error.code != LOST_STEPS:
                raise
            message = f"{error}; it is reset and the sweep taken again ({number} of {resets})"
        report.at(MissionPhase.SWEEPING, message=message)
        # The sweep ended halfway, with the laser on, and a reset may take half a minute.
        await context.robot.rangefinder.switch_laser(on=False)
        await context.robot.pantilt.reset()
    # Outside of the loop: after the last reset lost steps end the mission like any other failure.
    return await look()
