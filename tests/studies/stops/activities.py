"""What the robot is at when its daemon is ended; each is left in the middle of a motion, at a random moment of it."""

import asyncio
import math
from collections.abc import Awaitable, Callable

from robotd.app.compose import Daemon
from robotd.contract.missions import DriveTo, Legs, MapStart
from robotd.contract.requests import Arm
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.mission.motion.legs import next_odometry
from robotd.mission.whereabouts.tie import Tie
from tests.studies.stops.rig import Rig, start
from tests.support.places import head_of, place_of

_FAST_MPS, _FAST_RADPS = 0.2, 0.3
_PHASE_S = 0.1
"""Longer than any period of telemetry or of set-points."""
Activity = Callable[[Rig, Daemon], Awaitable["asyncio.Task[None]"]]


async def turning(rig: Rig, daemon: Daemon) -> "asyncio.Task[None]":
    """On the spot, towards a goal behind it."""
    return await _on_the_way(rig, daemon, math.pi * 0.9, lambda: abs(rig.robot._body.velocity[1]) > _FAST_RADPS)


async def driving(rig: Rig, daemon: Daemon) -> "asyncio.Task[None]":
    """At speed, straight ahead."""
    return await _on_the_way(rig, daemon, 0.0, lambda: rig.robot._body.velocity[0] > _FAST_MPS)


async def head_turning(rig: Rig, daemon: Daemon) -> "asyncio.Task[None]":
    """From one side to the other."""
    await daemon.control.perform(Arm())
    await daemon.robot.pantilt.aim(-1.5, 0.0, timeout_s=5.0)
    aiming = asyncio.create_task(_aim(daemon), name="client")
    await _until(lambda: rig.robot._head.arrives_us is not None)
    await asyncio.sleep(rig.random.uniform(0.0, _PHASE_S))
    return aiming


async def sweeping(rig: Rig, daemon: Daemon) -> "asyncio.Task[None]":
    """Some way round, the laser at work."""
    await daemon.control.perform(Arm())
    client = await start(daemon, MapStart.of("new", (), rig.robot.start))
    await _until(lambda: rig.robot._laser._on)
    await asyncio.sleep(rig.random.uniform(_PHASE_S, 3 * _PHASE_S))
    return client


async def _aim(daemon: Daemon) -> None:
    await asyncio.gather(daemon.robot.pantilt.aim(1.5, 0.2, timeout_s=5.0), return_exceptions=True)


async def _on_the_way(
    rig: Rig, daemon: Daemon, bearing_rad: float, is_fast: Callable[[], bool]
) -> "asyncio.Task[None]":
    await daemon.control.perform(Arm())
    here = rig.robot.truth
    grid = OccupancyGrid(GridSettings().spec_covering(((here.x_m, here.y_m),), 4.0))
    tie = Tie.between(here, (await next_odometry(daemon.robot.drive, 1.0)).in_odom)
    daemon.supervisor.use(await place_of(head_of(daemon), grid, "blank"), tie)
    way_rad = here.heading_rad + bearing_rad
    goal_m = here.x_m + 1.2 * math.cos(way_rad), here.y_m + 1.2 * math.sin(way_rad)
    client = await start(daemon, DriveTo(*goal_m, Legs.STRAIGHT))
    await _until(is_fast)
    await asyncio.sleep(rig.random.uniform(0.0, _PHASE_S))
    return client


async def _until(happens: Callable[[], bool]) -> None:
    async with asyncio.timeout(10.0):
        while not happens():  # noqa: ASYNC110  # nobody tells: it is in the physics
            await asyncio.sleep(0.001)


ACTIVITIES: dict[str, Activity] = {"turning": turning, "driving": driving, "head": head_turning, "sweeping": sweeping}
