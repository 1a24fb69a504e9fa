"""The head pointed somewhere, and one sweep without a map."""

import math

from robotd.contract.events import MissionPhase
from robotd.contract.missions import Look
from robotd.core.errors import MissionError
from robotd.core.reading import ReadingStatus
from robotd.mission.missions.context import MissionContext, Reporter


async def run_look(context: MissionContext, mission: Look) -> str:
    """Carry out a :class:`Look`; return what to tell the client.

    Raises:
        MissionError: the head does not reach there; nothing has moved.
        DeviceError, LinkTimeout, TransportError: the head failed.
    """
    head, pan_rad, tilt_rad = context.robot.pantilt, mission.pan_rad, mission.tilt_rad
    reach = await head.limits()
    _require("pan", pan_rad, reach.pan_min_rad, reach.pan_max_rad)
    _require("tilt", tilt_rad, reach.tilt_min_rad, reach.tilt_max_rad)
    timeout_s = context.settings.sweep.aim_timeout_s
    aim = await context.hold.through(lambda: head.aim(pan_rad, tilt_rad, timeout_s=timeout_s))
    return f"looks to pan {math.degrees(aim.pan_rad):.2f} deg, tilt {math.degrees(aim.tilt_rad):.2f} deg"


async def run_scan(context: MissionContext, report: Reporter) -> str:
    """Sweep once and return what to tell the client. Raises as :meth:`MissionContext.sweep`."""
    report.at(MissionPhase.SWEEPING)
    sweep = await context.sweep(next(context.sweep_numbers))
    hits = sum(reading.status is ReadingStatus.OK for reading in sweep.readings)
    return f"{hits} of {len(sweep.readings)} readings met an obstacle"


def _require(what: str, angle_rad: float, lowest_rad: float, highest_rad: float) -> None:
    if not lowest_rad <= angle_rad <= highest_rad:
        low_deg, high_deg, deg = map(math.degrees, (lowest_rad, highest_rad, angle_rad))
        raise MissionError(
            f"the head cannot look there: {what} must be {low_deg:.1f} to {high_deg:.1f} deg, got {deg:.1f}"
        )
