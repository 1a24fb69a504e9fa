"""The same with a daemon that is a process, on pseudo-terminals and the real clock; and with a loop that is stuck."""

import asyncio
import contextlib
import math
import signal
import tempfile
from pathlib import Path

from robotd.client import AsyncClient
from robotd.contract.missions import Legs, MapStart
from robotd.core.clock import NS_PER_S, now_ns
from robotd.sim.emulators.catalogue import Dialects
from tests.studies.stops.causes import SIGNALS
from tests.support.real_rig import DAEMON, STALLING_DAEMON, Rig, armed, rig, until
from tests.support.ways_to_end import far_end

STALL = "stall"
STALL_S = 2.0
"""Longer than any ramp: the robot must be at rest before the loop turns again."""
CAUSES = (*(number.name for number in SIGNALS), STALL)
ACTIVITIES = ("turning", "driving")
WATCHED_S = 1.7
_FAST_MPS, _FAST_RADPS = 0.15, 0.2
_LEASE_S = 10.0
_LOOK_S = 0.002
_BEHIND_M = 0.5
_ATTEMPTS = 5


def run_real_trials(dialects: Dialects, activity: str, cause: str, trials: int) -> list[float | None]:
    """Return how long after the cause the base came to rest [s], trial by trial; None if it moved on."""
    return asyncio.run(_trials(dialects, activity, cause, trials))


async def _trials(dialects: Dialects, activity: str, cause: str, trials: int) -> list[float | None]:
    with tempfile.TemporaryDirectory(prefix="robotd-stops-") as directory:
        async with rig(Path(directory), dialects) as it:
            return [await _trial(it, activity, cause) for _ in range(trials)]


async def _trial(it: Rig, activity: str, cause: str) -> float | None:
    program, more = (STALLING_DAEMON, (str(STALL_S),)) if cause == STALL else (DAEMON, ())
    async with it.daemon(program, "quick.toml", more) as daemon, AsyncClient(it.runtime_dir) as client:
        await _in_motion(it, client, activity)
        daemon.send_signal(signal.SIGRTMIN if cause == STALL else signal.Signals[cause])
        rest_s = await _rest_s(it)
        if cause != STALL:
            async with asyncio.timeout(10.0):
                await daemon.wait()
    with contextlib.suppress(TimeoutError):  # what drives on meets a wall, or the next daemon
        await until(lambda: it.robot.at_rest)
    return rest_s


async def _in_motion(it: Rig, client: AsyncClient, activity: str) -> None:
    """Wait until it moves as wanted; a busy machine may have stopped it before, and then it is told once more."""
    body = it.robot._body
    for _ in range(_ATTEMPTS):
        await armed(client)
        stop_m = _behind(it) if activity == "turning" else far_end(it)
        await client.start(MapStart.of("stops", (stop_m,), it.robot.truth, Legs.STRAIGHT), _LEASE_S)
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_LEASE_S):
                if activity == "turning":
                    await until(lambda: abs(body.velocity[1]) > _FAST_RADPS)
                else:
                    await until(lambda: body.velocity[0] > _FAST_MPS)
                return
        await client.stop("once more")
        await until(lambda: it.robot.at_rest)
    raise TimeoutError("it never moved as it was told")


async def _rest_s(it: Rig) -> float | None:
    began_ns = moved_ns = now_ns()
    while now_ns() < began_ns + WATCHED_S * NS_PER_S:
        if not it.robot.at_rest:
            moved_ns = now_ns()
        await asyncio.sleep(_LOOK_S)
    return (moved_ns - began_ns) / NS_PER_S if it.robot.at_rest else None


def _behind(it: Rig) -> tuple[float, float]:
    """Return a place to which it must turn round; it is ended on the way there."""
    here = it.robot.truth
    return here.x_m - _BEHIND_M * math.cos(here.heading_rad), here.y_m - _BEHIND_M * math.sin(here.heading_rad)
