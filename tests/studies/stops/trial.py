"""One trial: a robot in motion, a cause that ends its daemon, and whether the robot came to rest."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass

from robotd.core.clock import NS_PER_S, now_ns, run_virtual
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.robot import DEVICES
from tests.studies.stops.activities import ACTIVITIES, driving
from tests.studies.stops.causes import CAUSES, HEAD, HEAD_LOST
from tests.studies.stops.rig import Rig, rig
from tests.support.living import until_ready

LOOK_S = 0.002
WATCHED_S = 1.5
"""From cruising speed a base needs less."""
START_UP_S = 0.06
"""The cause comes so soon, at the latest, after the new daemon has opened the line of the base."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of it."""

    stop_s: float | None
    """From the cause to the stop on the last of the wires; None if a wire has none."""
    ended_s: float
    """From the cause to the end of the daemon."""
    rest_s: float | None
    """From the cause to the last motion; None if it moves on."""


def run_trial(dialects: Dialects, activity: str, cause: str, seed: int) -> Outcome:
    """Run one trial on the virtual clock."""
    return run_virtual(_trial(dialects, activity, cause, seed))


async def _trial(dialects: Dialects, activity: str, cause: str, seed: int) -> Outcome:
    async with rig(dialects, seed) as it:
        if activity == "start-up":
            await _left_driving(it)
        async with it.program() as (running, daemon):
            clients = []
            if activity == "start-up":
                while "drive" not in it.wires:  # noqa: ASYNC110  # nobody tells
                    await asyncio.sleep(LOOK_S)
                await asyncio.sleep(it.random.uniform(LOOK_S, START_UP_S))
            else:
                await until_ready(daemon)
                clients = [await ACTIVITIES[activity](it, daemon)]
            began_ns, wires = now_ns(), _wires_to_stop(activity, cause)
            CAUSES[cause](it, daemon)
            outcome = await _watched(it, running, began_ns, wires)
            for task in (*clients, *it.tasks):
                task.cancel()
            return outcome


def _wires_to_stop(activity: str, cause: str) -> Sequence[str]:
    """Return where a stop is due: not on a line that was cut, nor, at the start, where nothing can be armed."""
    if activity == "start-up":
        return ("drive",)
    return [device for device in DEVICES if cause != HEAD_LOST or device != HEAD]


async def _left_driving(it: Rig) -> None:
    """Let a daemon be killed while the base drives: the next one finds it so."""
    async with it.program() as (running, daemon):
        await until_ready(daemon)
        client = await driving(it, daemon)
        await it.kill(running)
        client.cancel()


async def _watched(it: Rig, running: "asyncio.Task[int]", began_ns: int, wires: Sequence[str]) -> Outcome:
    moved_ns = ended_ns = began_ns
    while now_ns() < began_ns + WATCHED_S * NS_PER_S:
        if not running.done():
            ended_ns = now_ns()
        if it.is_moving:
            moved_ns = now_ns()
        await asyncio.sleep(LOOK_S)
    rest_s = None if it.is_moving else (moved_ns - began_ns) / NS_PER_S
    return Outcome(it.stopped_s(began_ns, wires), (ended_ns - began_ns) / NS_PER_S, rest_s)
