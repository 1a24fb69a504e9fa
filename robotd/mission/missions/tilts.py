"""Where the head can look, and at which further tilts it must not: where the floor would be taken for walls."""

import math
from collections.abc import Sequence

from robotd.contract.arguments import TiltArgument
from robotd.core.errors import MissionError
from robotd.core.reading import Tilt
from robotd.hardware.devices.slant import slanted_beam
from robotd.mission.missions.context import MissionContext


async def tilts_of(context: MissionContext, asked: Sequence[TiltArgument]) -> tuple[Tilt, ...]:
    """Return the tilts that are asked for.

    Raises:
        MissionError: as :func:`require_tilts`, or one is named twice.
    """
    cut_off_m = context.settings.rangefinder.range_max_m
    tilts = tuple(Tilt(one.tilt_rad, cut_off_m if one.cut_off_m is None else one.cut_off_m) for one in asked)
    if len({context.settings.sweep.tilt_rad, *(tilt.tilt_rad for tilt in tilts)}) <= len(tilts):
        raise MissionError(
            "each further tilt must be another, and none that of the first look round, which is"
            f" {math.degrees(context.settings.sweep.tilt_rad):.1f} deg"
        )
    return await require_tilts(context, tilts)


async def require_tilts(context: MissionContext, tilts: Sequence[Tilt]) -> tuple[Tilt, ...]:
    """Return tilts, after a look at all of them.

    Raises:
        MissionError: the head does not reach one, or its beam meets the floor where it is believed: the floor would be
            taken for walls all round.
        DeviceError, LinkTimeout, TransportError: the head does not say how far it reaches.
    """
    if tilts:
        reach = await context.robot.pantilt.limits()
        for tilt in tilts:
            require_reach("tilt", tilt.tilt_rad, reach.tilt_min_rad, reach.tilt_max_rad)
            _require_sight(context, tilt)
    return tuple(tilts)


def _require_sight(context: MissionContext, tilt: Tilt) -> None:
    mount, nearest_m = context.settings.head_mount, context.settings.rangefinder.range_min_m
    where = f"at a tilt of {math.degrees(tilt.tilt_rad):.1f} deg"
    if tilt.cut_off_m <= nearest_m:
        raise MissionError(
            f"{where} nothing is seen: its cut-off must be above {nearest_m:.2f} m, got {tilt.cut_off_m}"
        )
    if tilt.tilt_rad < 0.0 and not mount.height_m:
        raise MissionError(f"{where} the beam meets the floor, and pantilt.height_m does not say where: measure it")
    # The lens turns with the pan, and how far before it the floor is does not: one direction stands for all.
    floor_m = slanted_beam(mount, 0.0, tilt.tilt_rad).floor_m
    if floor_m <= tilt.cut_off_m:
        raise MissionError(
            f"{where} the beam meets the floor at {floor_m:.2f} m, before its cut-off of {tilt.cut_off_m:.2f} m, and"
            " the floor would be taken for walls: name a cut-off before it, or tilt less"
        )


def require_reach(what: str, angle_rad: float, lowest_rad: float, highest_rad: float) -> None:
    """Refuse an angle that the head does not reach; MissionError says what it reaches."""
    if not lowest_rad <= angle_rad <= highest_rad:
        low_deg, high_deg, deg = map(math.degrees, (lowest_rad, highest_rad, angle_rad))
        raise MissionError(
            f"the head cannot look there: {what} must be {low_deg:.1f} to {high_deg:.1f} deg, got {deg:.1f}"
        )
