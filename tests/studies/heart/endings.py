"""The front killed or stopped in every mode: what moves rests as its lease says, and clients are served again."""

import asyncio
import contextlib
import os
import signal
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass

from robotd.client import AsyncClient
from robotd.contract.missions import DriveStraight, MapStart
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import ChildError, RobotdError
from tests.support.real_rig import Rig, armed, child_of, ms_since, until

LEASE_S = 0.3
_FAR_M = 0.8
_RENEWALS = 100


@dataclass(frozen=True, slots=True)
class Ended:
    """One trial."""

    stop_late_ms: float | None
    """After the end of the lease; None where nothing was under way."""
    away_ms: float
    """Until a client was answered by the next one."""
    is_as_before: bool
    """Whether a robot that was not on a mission is in the mode it was in."""


async def disarmed(rig: Rig, client: AsyncClient) -> bool:
    """Nothing may move."""
    await client.disarm()
    return False


async def idle(rig: Rig, client: AsyncClient) -> bool:
    """Armed, on no mission."""
    await armed(client)
    return False


async def sweeping(rig: Rig, client: AsyncClient) -> bool:
    """In the middle of a sweep."""
    await armed(client)
    rig.expect_stops()  # on a busy machine the lease may end before the front does
    await client.start(MapStart.of("heart", (), rig.robot.truth), LEASE_S)
    return True


async def driving(rig: Rig, client: AsyncClient) -> bool:
    """On the way, to and fro."""
    await armed(client)
    rig.expect_stops()
    ahead_m = (rig.robot.start.inverse() @ rig.robot.truth).x_m
    mission = await client.start(DriveStraight(-_FAR_M if ahead_m > 0.0 else _FAR_M), LEASE_S)
    for _ in range(_RENEWALS):  # on a busy machine the lease may end before it moves
        await client.renew(mission.mission_id)
        if not rig.robot.at_rest:
            break
    return True


MODES: dict[str, Callable[[Rig, AsyncClient], Awaitable[bool]]] = {
    "disarmed": disarmed,
    "idle": idle,
    "sweeping": sweeping,
    "driving": driving,
}


async def end_front(rig: Rig, daemon_pid: int, mode: str, number: signal.Signals) -> Ended:
    """End the front in a mode, and see what becomes of it."""
    async with AsyncClient(rig.runtime_dir, deadline_s=60.0, retry_s=0.02) as client:
        session = (await client.hello()).session
        is_on_mission = await MODES[mode](rig, client)
        before = (await client.status()).mode
        renewed_ns = now_ns()  # the lease began before this, so a stop may even be early
        if is_on_mission:
            with suppress(RobotdError):
                mission_id = (await client.status()).mission_id
                renewed_ns = now_ns()
                await client.renew(mission_id or 0)
        front = child_of(daemon_pid, "robotd.front")
        if front is None:
            raise ChildError("there is no front to end")
        ended_ns = now_ns()
        os.kill(front, number)
        late_ms = None
        if is_on_mission:
            late_ms = ms_since(renewed_ns + round(LEASE_S * NS_PER_S), await rig.stopped_ns())
        while True:
            with contextlib.suppress(RobotdError):
                if (await client.hello()).session != session:
                    break
            await asyncio.sleep(0.005)
        away_ms = ms_since(ended_ns, now_ns())
        after = (await client.status()).mode
        if is_on_mission:
            await until(lambda: rig.robot.at_rest)
        return Ended(late_ms, away_ms, is_on_mission or after == before)
