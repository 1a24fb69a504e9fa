"""Stops of a client beside others that take too much, and what that costs the daemon."""

import asyncio
import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Sequence
from contextlib import aclosing
from dataclasses import dataclass, field
from pathlib import Path

from robotd.children.inside import die_with_parent
from robotd.client import AsyncClient
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.missions import MapStart
from robotd.core.clock import now_ns
from robotd.core.errors import RobotdError
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps.store import MapStore
from tests.studies.lag.workload import large_grid
from tests.support.real_rig import Rig, armed, child_of, ms_since
from tests.support.repeated import Repeated, repeated

LEASE_S = 0.5
_UNDER_WAY_S = 0.2
_AGAIN_AFTER_S = 2.0


@dataclass
class Suffered:
    """What came of one attack."""

    stops: Repeated[float] = field(default_factory=Repeated)
    """How late each stop was on all wires [ms], counted from when the client asked for it."""
    heart_mib: float = 0.0
    front_mib: float = 0.0
    """The most memory each had."""
    lost: int = 0
    """Missions that ended before they were stopped."""
    deaths: int = 0
    """Of the front."""


async def suffer(rig: Rig, daemon_pid: int, attacks: Sequence[str], trials: int, share: float = 1.0) -> Suffered:
    """Stop missions while attackers are at work."""
    came_of_it = Suffered()
    before = child_of(daemon_pid, "robotd.front")
    async with AsyncClient(rig.runtime_dir, deadline_s=60.0) as client:
        await client.hello()
        async with contextlib.AsyncExitStack() as stack:
            beginning = [stack.enter_async_context(attacker(attack, rig.runtime_dir, share)) for attack in attacks]
            await asyncio.gather(*beginning)

            async def trial() -> float:
                late_ms = await _stopped_ms(rig, client, came_of_it)
                came_of_it.heart_mib = max(came_of_it.heart_mib, _mib(daemon_pid))
                came_of_it.front_mib = max(came_of_it.front_mib, _mib(before))
                return late_ms

            came_of_it.stops = await repeated(trials, trial)
    came_of_it.deaths += child_of(daemon_pid, "robotd.front") != before
    return came_of_it


async def _stopped_ms(rig: Rig, client: AsyncClient, came_of_it: Suffered) -> float:
    """Let a mission begin, go on for a while under its lease, and stop it."""
    while True:
        try:
            await armed(client)
            mission = MapStart.of("heart", (), rig.robot.start)
            async with aclosing(client.run_mission(mission, LEASE_S)) as said:
                async for event in said:
                    if isinstance(event, MissionProgress) and event.phase is MissionPhase.SWEEPING:
                        break
                await asyncio.sleep(_UNDER_WAY_S)  # a renewal or two
                if (await client.status()).mission_id is not None:
                    rig.expect_stops()
                    asked_ns = now_ns()
                    stopping = asyncio.create_task(client.stop("the trial"))
                    late_ms = ms_since(asked_ns, await rig.stopped_ns())
                    await stopping
                    return late_ms
        except RobotdError as error:
            # Of a flood only stops and renewals are kept free.
            if any(word in str(error) for word in ("busy", "clear")):
                await asyncio.sleep(_AGAIN_AFTER_S)
                continue
        came_of_it.lost += 1


@contextlib.asynccontextmanager
async def attacker(name: str, runtime_dir: Path, share: float) -> AsyncIterator[None]:
    """Run an attacker at normal priority, in a session of its own, for the length of the block."""
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "tests.studies.heart.attackers", name, str(runtime_dir), str(share)),
        stdout=subprocess.PIPE,
        start_new_session=True,
        preexec_fn=die_with_parent,
        cwd=Path(__file__).parents[3],
    )
    assert process.stdout is not None
    os.setpriority(os.PRIO_PROCESS, process.pid, 0)
    try:
        async with asyncio.timeout(60.0):
            await process.stdout.readline()
        yield
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        await process.wait()


def with_a_large_map(rig: Rig, grid: OccupancyGrid | None = None) -> None:
    """Lay a map into the store that takes long to read, pack and send."""
    MapStore(rig.directory / "maps").save("large", grid or large_grid(), {}, 0)


def _mib(pid: int | None) -> float:
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * 4096 / 2**20
    except (OSError, ValueError):
        return 0.0
