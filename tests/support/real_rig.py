"""A real daemon on real pseudo-terminals and the real clock; stops are timed at the boards' end of the line."""

import asyncio
import contextlib
import os
import random
import signal
import sys
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from pathlib import Path

from robotd.children.inside import die_with_parent
from robotd.cli.emulated import config_text
from robotd.client import AsyncClient
from robotd.contract.device_status import LinkState
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.transport import Transport
from robotd.hardware.wire.board import STOP_BYTES
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.faults.fault import Fault
from robotd.sim.faults.laid import cables_on_ptys
from robotd.sim.robot import SimulatedRobot

NICE = -15
"""As systemd/robotd.service has it, where it is allowed."""
SESSION_NICE = -10
"""Ten times the share of another session, as the unit's CPUWeight= has it beside another service."""
DAEMON = ("-m", "robotd.app.daemon", "--log-level", "error", "--config")
STALLING_DAEMON = ("-m", "tests.studies.safety.stalling")
_PATIENCE_S = 60.0
_ROOT = Path(__file__).parents[2]


class Watch(Fault):
    """Harms nothing; notes when a stop arrives at the board."""

    def __init__(self, device: str) -> None:
        super().__init__(random.Random(0))
        self.device = device
        self.last_ns = 0
        self.arrived = asyncio.Event()

    async def pass_on(self, data: bytes, way: Direction, sink: Transport) -> None:
        if way is Direction.TO_BOARD and STOP_BYTES in data:
            self.last_ns = now_ns()
            self.arrived.set()
        await super().pass_on(data, way, sink)


@dataclass(slots=True)
class Rig:
    """The boards, who watches them, and how to start daemons on them."""

    robot: SimulatedRobot
    watches: tuple[Watch, ...]
    directory: Path

    @property
    def runtime_dir(self) -> Path:
        return self.directory / "run"

    @contextlib.asynccontextmanager
    async def daemon(
        self, program: tuple[str, ...] = DAEMON, config: str = "robotd.toml", more: tuple[str, ...] = ()
    ) -> AsyncIterator[asyncio.subprocess.Process]:
        """Start a daemon and wait until its devices are ready; kill it in the end if it still lives."""
        async with program_of(*program, str(self.directory / config), *more) as process:
            give_precedence(process.pid)
            async with AsyncClient(self.runtime_dir) as client:
                await until_ready(client)
            yield process

    def expect_stops(self) -> None:
        """Look out for stops from here on."""
        for watch in self.watches:
            watch.arrived.clear()

    async def stopped_ns(self) -> int:
        """Return when the first stop since then had arrived on every wire."""
        async with asyncio.timeout(_PATIENCE_S):
            for watch in self.watches:
                await watch.arrived.wait()
        return max(watch.last_ns for watch in self.watches)


@contextlib.asynccontextmanager
async def program_of(*arguments: str, stderr: int | None = None) -> AsyncIterator[asyncio.subprocess.Process]:
    """Start a Python program in a session of its own; kill it in the end if it still lives."""
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, *arguments),
        stdout=asyncio.subprocess.PIPE,
        stderr=stderr,
        cwd=_ROOT,
        start_new_session=True,
        # A daemon that outlives a run that was killed goes on opening its lines, and pseudo-terminals are numbered
        # again: the next run's daemon finds its own taken, and is never ready.
        preexec_fn=die_with_parent,
    )
    try:
        yield process
    finally:
        if process.returncode is None:
            process.send_signal(signal.SIGKILL)
        await process.wait()


def child_of(pid: int, module: str) -> int | None:
    """Return the process that a daemon has for a module, if there is one now."""
    for status in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, IndexError):
            parent = status.read_text().rpartition(")")[2].split()[1]
            if parent == str(pid) and module.encode() in (status.parent / "cmdline").read_bytes():
                return int(status.parent.name)
    return None


def give_precedence(pid: int) -> None:
    """Let a process and its session go before others, where this is allowed.

    Between sessions niceness counts for nothing if the kernel shares processors out among sessions, as most do.
    """
    with contextlib.suppress(PermissionError, FileNotFoundError):
        os.setpriority(os.PRIO_PROCESS, pid, NICE)
        Path(f"/proc/{pid}/autogroup").write_text(str(SESSION_NICE))


async def until_ready(client: AsyncClient) -> None:
    """Wait until every device is there."""
    async with asyncio.timeout(_PATIENCE_S):
        while True:
            with contextlib.suppress(RobotdError):
                if all(device.link is LinkState.READY for device in (await client.status()).devices):
                    return
            await asyncio.sleep(0.05)


async def armed(client: AsyncClient) -> None:
    """Arm, clearing what the boards latched."""
    with contextlib.suppress(RobotdError):
        await client.arm()
        return
    await client.clear()
    await client.arm()


@contextlib.asynccontextmanager
async def rig(directory: Path, dialects: Dialects | None = None) -> AsyncIterator[Rig]:
    """Put a robot's boards on pseudo-terminals, with a configuration to run a daemon on them."""
    dialects = dialects or Dialects()
    robot = SimulatedRobot(load_world("laboratory"), seed=4, dialects=dialects)
    async with cables_on_ptys(robot, directory / "devices") as (laid, ports):
        watches = tuple(Watch(device) for device in laid)
        for watch in watches:
            laid[watch.device].set_fault(watch)
        text = config_text(ports, dialects.settings())
        for name, more in (
            ("robotd.toml", ""),
            ("quick.toml", "\n[sweep]\nreadings = 4\n"),
            ("few.toml", "\n[sweep]\nreadings = 40\n"),
        ):
            (directory / name).write_text(text + more)
        yield Rig(robot, watches, directory)


def ms_since(began_ns: int, ended_ns: int) -> float:
    return (ended_ns - began_ns) / NS_PER_S * 1000.0


async def until(happens: Callable[[], object]) -> None:
    """Look every millisecond whether something is so; if that takes too long, something else has stopped the robot.

    Raises:
        TimeoutError: it did.
    """
    async with asyncio.timeout(_PATIENCE_S):
        while not happens():  # noqa: ASYNC110  # nobody tells: it is in another process, or in the physics
            await asyncio.sleep(0.001)
