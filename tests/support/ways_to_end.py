"""What must stop the robot, each tried again and again; a trial yields how late the stop was [ms]."""

import asyncio
import math
import multiprocessing
import os
import signal
from collections.abc import AsyncIterator
from contextlib import aclosing
from multiprocessing.synchronize import Event
from pathlib import Path

from firmware_proto.common import Fault
from robotd.app.stall_guard import STALL_S
from robotd.client import AsyncClient
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.missions import DriveTo, Legs, MapStart
from robotd.contract.topics import Topic
from robotd.core.clock import NS_PER_S, now_ns
from tests.support.real_rig import STALLING_DAEMON, Rig, armed, ms_since, until

LEASE_S = 0.1
CLIENT_LEASE_S = 0.5
_MOVING_MPS = 0.15
_AWAY_M = 0.8
_UNDER_WAY_S = 0.3
_TTL_S = 0.4
"""Of a set-point, as ``driving.setpoint_ttl_s`` has it by default."""


async def lease_expiry(rig: Rig, trials: int) -> AsyncIterator[float]:
    """The client stays and says nothing: from the end of its lease."""
    async with rig.daemon(), AsyncClient(rig.runtime_dir) as client:
        with client.subscribe(Topic.MISSION) as events:
            for _ in range(trials):
                await armed(client)
                rig.expect_stops()
                await client.start(MapStart.of("safety", (), rig.robot.start), LEASE_S)
                async for event in events:
                    if isinstance(event, MissionProgress) and event.phase is MissionPhase.STARTED:
                        began_ns = event.time_ns
                        break
                yield ms_since(began_ns + round(LEASE_S * NS_PER_S), await rig.stopped_ns())


async def client_killed(rig: Rig, trials: int) -> AsyncIterator[float]:
    """The client renews its lease and is killed: from the end of the lease that it can have renewed last."""
    processes = multiprocessing.get_context("forkserver")
    processes.set_forkserver_preload([__name__])
    first = processes.Process(target=int)
    first.start()  # waits until all is imported: not later, for the boards live in this process
    first.join()
    async with rig.daemon(), AsyncClient(rig.runtime_dir) as client:
        for _ in range(trials):
            await armed(client)
            running = processes.Event()
            holder = processes.Process(target=_hold_on, args=(rig.runtime_dir, running), daemon=True)
            holder.start()
            await until(running.is_set)
            await asyncio.sleep(0.3)  # a renewal or two
            rig.expect_stops()
            killed_ns = now_ns()
            holder.kill()
            yield ms_since(killed_ns + round(CLIENT_LEASE_S * NS_PER_S), await rig.stopped_ns())
            holder.join()


def _hold_on(runtime_dir: Path, running: Event) -> None:
    os.setpriority(os.PRIO_PROCESS, 0, 0)  # a client is nobody special: this one came from the boards' process

    async def hold() -> None:
        mission = MapStart("safety", ())
        async with AsyncClient(runtime_dir) as client, aclosing(client.run_mission(mission, CLIENT_LEASE_S)) as events:
            async for _ in events:
                running.set()

    asyncio.run(hold())


async def loop_stall(rig: Rig, trials: int) -> AsyncIterator[float]:
    """The loop computes for 0.4 s while the base is driven: from 0.2 s after that began, when the guard must act."""
    async with rig.daemon(STALLING_DAEMON, "few.toml") as daemon, AsyncClient(rig.runtime_dir) as client:
        assert daemon.stdout is not None
        start = rig.robot.start
        await armed(client)
        await client.make_map("safety", (), start)
        for trial in range(trials):
            await client.stop("the next trial")  # the one before is held, and would go on
            await armed(client)
            y_m = start.y_m + (_AWAY_M if trial % 2 == 0 else -_AWAY_M)  # never where it may already be
            await client.start(DriveTo(start.x_m, y_m, Legs.STRAIGHT), CLIENT_LEASE_S)
            await asyncio.sleep(_UNDER_WAY_S)
            rig.expect_stops()
            os.kill(daemon.pid, signal.SIGRTMIN)
            stalled_ns = int(await daemon.stdout.readline())
            yield ms_since(stalled_ns + round(STALL_S * NS_PER_S), await rig.stopped_ns())


async def sigterm(rig: Rig, trials: int) -> AsyncIterator[float]:
    """The daemon is told to end, in the middle of a mission: from the signal; each time a new daemon."""
    for _ in range(trials):
        async with rig.daemon() as daemon, AsyncClient(rig.runtime_dir) as client:
            await armed(client)
            await client.start(MapStart.of("safety", (), rig.robot.start), 5.0)
            await asyncio.sleep(0.3)
            rig.expect_stops()
            told_ns = now_ns()
            daemon.send_signal(signal.SIGTERM)
            yield ms_since(told_ns, await rig.stopped_ns())
            await daemon.wait()


async def daemon_killed(rig: Rig, trials: int) -> AsyncIterator[float]:
    """The daemon is killed while the base moves: from the end of the last set-point's life to the deadman's stop."""
    body = rig.robot._body
    for _ in range(trials):
        async with rig.daemon(config="quick.toml") as daemon, AsyncClient(rig.runtime_dir) as client:
            await armed(client)
            await client.start(MapStart.of("safety", (far_end(rig),), rig.robot.truth, Legs.STRAIGHT), 10.0)
            await until(lambda: body.velocity[0] > _MOVING_MPS)
            killed_ns = now_ns()
            daemon.kill()
            await until(lambda: Fault.DEADMAN in getattr(rig.robot.boards["drive"], "faults", Fault.NONE))
            yield ms_since(killed_ns + round(_TTL_S * NS_PER_S), now_ns())
            await until(lambda: rig.robot.at_rest)


def far_end(rig: Rig) -> tuple[float, float]:
    """Return the end of a free way that is farther from here."""
    start, here = rig.robot.start, rig.robot.truth
    return max(
        ((start.x_m, start.y_m), rig.robot.stops_m[0]), key=lambda end: math.hypot(end[0] - here.x_m, end[1] - here.y_m)
    )


ON_C_BOARDS = "killed, C boards"
CAUSES = {
    "lease expiry": lease_expiry,
    "client killed": client_killed,
    "loop stall": loop_stall,
    "SIGTERM": sigterm,
    "daemon killed": daemon_killed,
    ON_C_BOARDS: daemon_killed,
}
