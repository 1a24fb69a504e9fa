"""One trial: the head of a real daemon is killed or stopped while the robot is at something."""

import asyncio
import contextlib
import os
import random
import signal
from collections.abc import AsyncIterator
from contextlib import aclosing
from dataclasses import dataclass
from pathlib import Path

from robotd.client import AsyncClient
from robotd.contract.events import MapChanged, MissionPhase, MissionProgress
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart, Mission
from robotd.core.clock import now_ns
from robotd.core.errors import MissionError
from robotd.core.grid_bytes import grid_digest
from tests.support.real_rig import Rig, armed, child_of, ms_since, rig, until

STATES = ("idle", "mapping", "localizing", "driving")
WAYS = {"kill -9": signal.SIGKILL, "SIGSTOP": signal.SIGSTOP}
_LEASE_S = 5.0
_LONGEST_S = 90.0


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of a trial."""

    stop_ms: float | None
    """How late the stop was on the last wire; None if none was asked for."""
    back_s: float
    """After what time another head was there and the map shown, or the mission done."""
    wrong: str = ""


@dataclass(frozen=True, slots=True)
class Subject:
    """A daemon, its robot, and its client."""

    rig: Rig
    pid: int
    client: AsyncClient

    @property
    def head(self) -> int | None:
        """The process that computes, if there is one now."""
        return child_of(self.pid, "robotd.head")

    async def trial(self, state: str, way: str, rng: random.Random) -> Outcome:
        """Let the head go while the robot is at something; ask for a stop in every second trial."""
        before = await self._shown()
        mission = None if state == "idle" else asyncio.create_task(self._done(self._mission(state)))
        await asyncio.sleep(rng.uniform(0.0, 1.0))
        await until(lambda: self.head is not None)
        old = self.head
        assert old is not None
        began_ns = now_ns()
        os.kill(old, WAYS[way])
        stop_ms = await self._stop(rng) if rng.random() < 0.5 else None
        wrong = [] if mission is None else [await self._end_of(mission, is_stopped=stop_ms is not None)]
        after = await self._shown()
        if state in {"idle", "localizing", "driving"} and digest_of(before) != digest_of(after):
            wrong.append("another map is in use")
        if self.head == old:
            wrong.append("the old head is there")
        return Outcome(stop_ms, ms_since(began_ns, now_ns()) / 1000.0, "; ".join(filter(None, wrong)))

    async def _stop(self, rng: random.Random) -> float:
        await asyncio.sleep(rng.uniform(0.0, 0.3))
        self.rig.expect_stops()
        asked_ns = now_ns()
        await self.client.stop("a trial")
        return ms_since(asked_ns, await self.rig.stopped_ns())

    async def _end_of(self, mission: "asyncio.Task[MissionProgress]", *, is_stopped: bool) -> str:
        end = await mission
        allowed = {MissionPhase.STOPPED, MissionPhase.DONE} if is_stopped else {MissionPhase.DONE}
        return "" if end.phase in allowed else f"{end.kind} {end.phase}: {end.message}"

    async def _done(self, mission: Mission) -> MissionProgress:
        last: MissionProgress | None = None
        # How it ended is in its last word: that it was stopped is what was asked for.
        with contextlib.suppress(MissionError):
            async with aclosing(self.client.run_mission(mission, _LEASE_S)) as events:
                async for event in events:
                    last = event if isinstance(event, MissionProgress) else last
        assert last is not None
        return last

    async def _shown(self) -> MapChanged:
        await armed(self.client)
        async with asyncio.timeout(_LONGEST_S):
            return await self.client.map_show()

    def _mission(self, state: str) -> Mission:
        here = self.rig.robot.truth
        ways: dict[str, Mission] = {
            "mapping": MapStart.of("trial", (), here),
            "localizing": Localize(tie=False),
            "driving": DriveTo(here.x_m + 0.05, here.y_m, Legs.STRAIGHT),
        }
        return ways[state]

    async def begin(self) -> None:
        """Make the map that trials are about."""
        await armed(self.client)
        end = await self._done(self._mission("mapping"))
        assert end.phase is MissionPhase.DONE, end


def digest_of(shown: MapChanged) -> str:
    """Return the digest of a whole map."""
    return grid_digest(shown.spec, shown.values)


@contextlib.asynccontextmanager
async def subject(directory: Path) -> AsyncIterator[Subject]:
    """Start a daemon with a map in use."""
    async with rig(directory) as it, it.daemon(config="few.toml") as daemon, AsyncClient(it.runtime_dir) as client:
        one = Subject(it, daemon.pid, client)
        await one.begin()
        yield one
