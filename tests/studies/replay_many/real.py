"""One random session in real time: a daemon, boards and clients that are processes, and their replay in this one."""

import asyncio
import contextlib
import os
import random
import shutil
import signal
import tempfile
from asyncio.subprocess import DEVNULL, Process
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import AbstractAsyncContextManager, AsyncExitStack, aclosing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import msgspec

from robotd.app.replaying import replay_recording
from robotd.cli.emulated import config_text
from robotd.client import AsyncClient
from robotd.config import effective_text, loads
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart, Mission
from robotd.core.errors import RobotdError
from robotd.sim.buildings.world import load_world
from robotd.sim.faults.fault_words import FAULTS
from robotd.sim.robot import DEVICES, SimulatedRobot
from tests.studies.replay_many.outcome import Outcome, difference
from tests.support.real_rig import DAEMON, STALLING_DAEMON, armed, child_of, program_of, until_ready

WORLD = "laboratory"
READINGS = 40
_LEASE_S = 0.5
_PAUSE_MAX_S = 2.0
_STILL_MAX_S = 1.5
_FAULTS_MAX = 3
_FAULTS_S = 20.0
"""When the last fault begins, at the latest."""
_ROBOTCTL = ("-m", "robotd.cli.main")
_LONGEST_S = 180.0
_END_S = 30.0


class Ends:
    """How a recording ends."""

    STOPPED, KILLED = "record stop", "SIGKILL"
    SIGNALS = ("SIGTERM", "SIGINT", KILLED)


def run_real_session(seed: int, actions: int, kept: Path) -> Outcome:
    """Live through a session, and replay it; a recording that replays to anything else is kept in a directory."""
    with tempfile.TemporaryDirectory(prefix="robotd-replays-") as directory:
        session = _Session(random.Random(f"real session {seed}"), Path(directory), seed)
        asyncio.run(session.run(actions))
        (file,) = (Path(directory) / "recordings").glob("*.mcap")
        report = replay_recording(file)
        end = session.done[-1]
        differs = difference(report, was_cut=end == Ends.KILLED)
        copy = None if differs is None else _kept(file, kept / f"real-{seed}.mcap")
    return Outcome(seed, tuple(session.done), differs, report.results, copy)


def _kept(file: Path, copy: Path) -> Path:
    copy.parent.mkdir(parents=True, exist_ok=True)
    return Path(shutil.copy(file, copy))


@dataclass
class _Session:
    rng: random.Random
    directory: Path
    seed: int
    done: list[str] = field(default_factory=list)

    @property
    def _runtime_dir(self) -> Path:
        return self.directory / "run"

    async def run(self, actions: int) -> None:
        """Start boards, daemon and client, let things happen, and end the daemon."""
        config = self._write_config()
        program = self.rng.choice((DAEMON, (*STALLING_DAEMON,)))
        self._stalls = program == STALLING_DAEMON
        async with asyncio.timeout(_LONGEST_S), AsyncExitStack() as stack:
            self._stack = stack
            self._boards = await self._start_boards(self._plan())
            self._daemon = await stack.enter_async_context(self._start(*program, str(config)))
            self._client = await stack.enter_async_context(AsyncClient(self._runtime_dir, deadline_s=_END_S))
            self._missions = await stack.enter_async_context(_cancelled())
            await until_ready(self._client)
            for _ in range(actions):
                await asyncio.sleep(self.rng.uniform(0.0, self.rng.choice((0.01, _PAUSE_MAX_S))))
                await self._act()
            await self._end()

    def _start(self, *arguments: str) -> AbstractAsyncContextManager[Process]:
        return program_of(*arguments, stderr=DEVNULL)  # what goes wrong here goes wrong on purpose

    def _write_config(self) -> Path:
        config = loads(config_text({device: str(self.directory / "devices" / device) for device in DEVICES}))
        config = replace(
            config,
            server=replace(config.server, runtime_dir=str(self._runtime_dir)),
            maps=replace(config.maps, dir=str(self.directory / "maps")),
            recording=replace(config.recording, dir=str(self.directory / "recordings"), from_start=True),
            sweep=replace(config.sweep, readings=READINGS),
        )
        file = self.directory / "robotd.toml"
        file.write_text(effective_text(config))
        return file

    def _plan(self) -> str:
        """Return faults of the cables, at most one on each: they begin whenever they do."""
        hit = self.rng.sample(DEVICES, self.rng.randint(0, _FAULTS_MAX))
        return ",".join(
            f"{device}:{self.rng.choice(tuple(FAULTS))}@{self.rng.uniform(3.0, _FAULTS_S):.3f}s"
            f"+{self.rng.uniform(0.1, 2.0):.3f}s"
            for device in hit
        )

    async def _start_boards(self, plan: str) -> Process:
        if plan:
            self.done.append(f"faults {plan}")
        arguments = ("sim", WORLD, "--seed", str(self.seed), "--links", str(self.directory / "devices"))
        faults = ("--faults", plan) if plan else ()
        return await self._stack.enter_async_context(self._start(*_ROBOTCTL, *arguments, *faults))

    async def _act(self) -> None:
        name, act = self.rng.choice(tuple(self._acts().items()))
        self.done.append(name)
        try:
            await act()
        except RobotdError as error:  # refused, as happens to clients
            self.done.append(f"({error})")

    def _acts(self) -> dict[str, Callable[[], Coroutine[Any, Any, None]]]:
        robot = SimulatedRobot(load_world(WORLD))
        new_map = MapStart.of("new", robot.stops_m, robot.start, Legs.STRAIGHT)
        return {
            "arm": self._client.arm,
            "arm again": lambda: armed(self._client),
            "map": lambda: self._mission(msgspec.structs.replace(new_map, stops_m=())),
            "map and drive": lambda: self._mission(new_map),
            "localize": lambda: self._mission(Localize()),
            "drive": lambda: self._mission(DriveTo(*robot.stops_m[0], Legs.STRAIGHT)),
            "map, renewed never": lambda: self._unrenewed(new_map),
            "client killed": self._client_killed,
            "client frozen": self._client_frozen,
            "stop": lambda: self._client.stop("enough"),
            "clear": self._client.clear,
            "arm and stop": self._arm_and_stop,
            "save": self._save,
            "load": self._load,
            "boards frozen": lambda: self._still(self._boards),
            "boards killed": self._boards_killed,
            "daemon frozen": lambda: self._still(self._daemon),
            "daemon stalled": self._stall,
            "head killed": lambda: self._to_child("head", signal.SIGKILL),
            "head frozen": lambda: self._to_child("head", signal.SIGSTOP),  # and killed, when it was silent for long
            "front killed": lambda: self._to_child("front", signal.SIGKILL),
            "front frozen": lambda: self._to_child("front", signal.SIGSTOP),  # as above
        }

    async def _mission(self, mission: Mission) -> None:
        """Start a mission as a client does that looks on, and wait a while for what comes of it."""
        await armed(self._client)
        following = asyncio.create_task(self._follow(mission))
        self._missions.add(following)
        await asyncio.wait({following}, timeout=self.rng.uniform(0.0, 6.0))

    async def _follow(self, mission: Mission) -> None:
        with contextlib.suppress(RobotdError):
            async with aclosing(self._client.run_mission(mission, _LEASE_S)) as events:
                async for _ in events:
                    """It is renewed meanwhile."""

    async def _unrenewed(self, mission: Mission) -> None:
        await armed(self._client)
        await self._client.start(mission, _LEASE_S)

    @contextlib.asynccontextmanager
    async def _another_client(self) -> AsyncIterator[Process]:
        await armed(self._client)
        command = (
            "map",
            "start",
            "new",
            "--world",
            WORLD,
            "--runtime-dir",
            str(self._runtime_dir),
            "--legs",
            "straight",
        )
        async with self._start(*_ROBOTCTL, *command) as client:
            await asyncio.sleep(self.rng.uniform(0.5, 3.0))
            yield client

    async def _client_killed(self) -> None:
        async with self._another_client():
            """It is killed at the end of the block."""

    async def _client_frozen(self) -> None:
        async with self._another_client() as client:
            await self._still(client)
            await asyncio.sleep(self.rng.uniform(0.0, 1.0))

    async def _arm_and_stop(self) -> None:
        arming = asyncio.create_task(armed(self._client))
        await asyncio.sleep(self.rng.uniform(0.0, 0.02))
        await self._client.stop("enough")
        await arming

    async def _save(self) -> None:
        await self._client.map_save("saved")

    async def _load(self) -> None:
        await self._client.map_load("saved")

    async def _still(self, process: Process) -> None:
        """Let a process stand still for a while."""
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGSTOP)
            await asyncio.sleep(self.rng.uniform(0.05, _STILL_MAX_S))
            process.send_signal(signal.SIGCONT)

    async def _to_child(self, name: str, number: signal.Signals) -> None:
        """Send a signal to one of the daemon's other processes; in a replay none dies."""
        child = child_of(self._daemon.pid, f"robotd.{name}")
        if child is not None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(child, number)

    async def _boards_killed(self) -> None:
        """Cut the power of all boards, and give it back."""
        self._boards.kill()
        await self._boards.wait()
        await asyncio.sleep(self.rng.uniform(0.0, 0.5))
        self._boards = await self._start_boards("")

    async def _stall(self) -> None:
        if self._stalls:
            self._daemon.send_signal(signal.SIGRTMIN)
            await asyncio.sleep(0.5)

    async def _end(self) -> None:
        end = self.rng.choice((Ends.STOPPED, *Ends.SIGNALS))
        self.done.append(end)
        if end == Ends.STOPPED:
            await self._client.record_stop()
            end = Ends.SIGNALS[0]
        # Looked up before it ends: whose child one was cannot be asked afterwards.
        children = [child_of(self._daemon.pid, f"robotd.{name}") for name in ("front", "head")]
        self._daemon.send_signal(signal.Signals[end])
        if end == Ends.KILLED:
            # They die with it, but for one that was frozen as it began: it would hold our pipe for good.
            for child in filter(None, children):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(child, signal.SIGKILL)
        async with asyncio.timeout(_END_S):
            await self._daemon.wait()


@contextlib.asynccontextmanager
async def _cancelled() -> AsyncIterator["set[asyncio.Task[None]]"]:
    """Yield a set of tasks that are cancelled in the end.

    Each says stop as it leaves its mission, and would wait for an answer for as long as its client has patience: a
    daemon that has ended gives none.
    """
    tasks: set[asyncio.Task[None]] = set()
    try:
        yield tasks
    finally:
        for _ in range(2):
            for task in tasks:
                task.cancel()
            await asyncio.sleep(0)
        await asyncio.gather(*tasks, return_exceptions=True)
