"""The head pointed somewhere, ranges measured there, and one sweep without a map."""

import math
import statistics

from robotd.contract.events import MissionPhase, RangeMeasured
from robotd.contract.missions import Look, Measure, Scan
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.rangefinder import Shot
from robotd.mission.missions.context import MissionContext, Reporter
from robotd.mission.missions.tilts import require_reach


async def run_look(context: MissionContext, mission: Look) -> str:
    """Carry out a :class:`Look`; return what to tell the client.

    Raises:
        MissionError: the head does not reach there; nothing has moved.
        DeviceError, LinkTimeout, TransportError: the head failed.
    """
    head, pan_rad, tilt_rad = context.robot.pantilt, mission.pan_rad, mission.tilt_rad
    reach = await head.limits()
    require_reach("pan", pan_rad, reach.pan_min_rad, reach.pan_max_rad)
    require_reach("tilt", tilt_rad, reach.tilt_min_rad, reach.tilt_max_rad)
    timeout_s = context.settings.sweep.aim_timeout_s
    # Through holds: a stop also stops the head, and what stopped half-way would be told as where it looks.
    aim = await context.hold.through(lambda: head.aim(pan_rad, tilt_rad, timeout_s=timeout_s))
    return f"looks to pan {math.degrees(aim.pan_rad):.2f} deg, tilt {math.degrees(aim.tilt_rad):.2f} deg"


async def run_measure(context: MissionContext, mission: Measure, report: Reporter) -> str:
    """Carry out a :class:`Measure`; return what to tell the client.

    A measurement that failed is a result, as in a sweep.

    Raises:
        DeviceError, LinkTimeout, TransportError: the rangefinder failed; what stops the robot puts the laser out.
    """
    report.at(MissionPhase.SWEEPING)
    laser, shots = context.robot.rangefinder, list[Shot]()
    await context.hold.through(lambda: laser.switch_laser(on=True))
    # Counted from here, when the laser is on: only a hold after that has put it out.
    holds = context.hold.count

    async def shoot() -> Shot:
        if context.hold.count != holds:
            await laser.switch_laser(on=True)  # the stop put it out
        return await laser.shoot(timeout_s=context.settings.sweep.shot_timeout_s)

    for number in range(mission.count):
        shot = await context.hold.through(shoot)
        context.publish(RangeMeasured(shot.time_ns, number, mission.count, shot.status, shot.range_m, shot.strength))
        shots.append(shot)
    await laser.switch_laser(on=False)
    return _shots_in_words(shots)


def _shots_in_words(shots: list[Shot]) -> str:
    ranges_m = [shot.range_m for shot in shots if shot.status is ReadingStatus.OK and shot.range_m is not None]
    if not ranges_m:
        return f"nothing measured: {shots[-1].status}"
    # A deviation takes two.
    spread = f", give or take {statistics.stdev(ranges_m):.4f} m" if len(ranges_m) > 1 else ""
    return f"{statistics.fmean(ranges_m):.4f} m{spread}, {len(ranges_m)} of {len(shots)} measured"


async def run_scan(context: MissionContext, mission: Scan, report: Reporter) -> str:
    """Sweep once and return what to tell the client. Raises as :meth:`MissionContext.sweep`."""
    report.at(MissionPhase.SWEEPING)
    sweep = await context.sweep(next(context.sweep_numbers), base_turns=mission.base_turns)
    hits = sum(reading.status is ReadingStatus.OK for reading in sweep.readings)
    return f"{hits} of {len(sweep.readings)} readings met an obstacle"
