"""What a crowd of browsers costs a gateway and the daemon behind it, and what the browsers see."""

import asyncio
import contextlib
import json
import os
import sys
import tempfile
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

from robotd.client import AsyncClient
from robotd.core.clock import NS_PER_S, now_ns
from tests.support.real_gateway import RealGateway, real_gateway
from tests.support.real_rig import Rig, rig

_TICKS_PER_S = os.sysconf("SC_CLK_TCK")
_PAGE_MIB = os.sysconf("SC_PAGE_SIZE") / 2**20
_CROWD = ("-m", "tests.studies.console.crowd")
_ROOT = Path(__file__).parents[3]


@dataclass(frozen=True, slots=True)
class House:
    """A daemon on simulated boards, and a gateway before it."""

    rig: Rig
    daemon: asyncio.subprocess.Process
    gateway: RealGateway
    client: AsyncClient


@contextlib.asynccontextmanager
async def house() -> AsyncIterator[House]:
    """Run both, real processes on the real clock."""
    with tempfile.TemporaryDirectory(prefix="robotd-console-") as directory:
        async with (
            rig(Path(directory)) as it,
            it.daemon() as daemon,
            AsyncClient(it.runtime_dir) as client,
            real_gateway(it.directory, it.runtime_dir) as gateway,
        ):
            yield House(it, daemon, gateway, client)


@dataclass(frozen=True, slots=True)
class Cost:
    """What processes took over some time."""

    gateway_share: float
    """Of one processor."""
    daemon_share: float
    """Of one processor, its children with it."""
    gateway_mib: float
    """Resident, at the end."""
    gateway_mib_more: float
    """By how much that grew."""
    daemon_mib_more: float


@dataclass(frozen=True, slots=True)
class CrowdSeen:
    """What those of a crowd saw that read."""

    p50_ms: float
    p95_ms: float
    messages: int
    bytes_per_s: float
    """Each."""
    hung_up: int
    """How many were hung up on."""


class Meter:
    """Counts from where it is made."""

    def __init__(self, it: House) -> None:
        self._gateway = it.gateway.process.pid
        self._daemon = it.daemon.pid
        self._begun_ns = now_ns()
        self._before = self._counted()

    def read(self) -> Cost:
        """Return what it came to."""
        passed_s = (now_ns() - self._begun_ns) / NS_PER_S
        gateway_s, daemon_s, gateway_mib, daemon_mib = self._counted()
        return Cost(
            (gateway_s - self._before[0]) / passed_s,
            (daemon_s - self._before[1]) / passed_s,
            gateway_mib,
            gateway_mib - self._before[2],
            daemon_mib - self._before[3],
        )

    def _counted(self) -> tuple[float, float, float, float]:
        daemon = _family(self._daemon)
        return (
            cpu_s(self._gateway),
            sum(map(cpu_s, daemon)),
            _resident_mib(self._gateway),
            sum(map(_resident_mib, daemon)),
        )


async def with_crowd(
    it: House, pages: int, seconds: float, *, stalled: int = 0, hostile: int = 0
) -> tuple[CrowdSeen, Cost]:
    """Let a crowd look for so long; what it saw, and what that took, both of the second half."""
    counts = ("--pages", str(pages), "--stalled", str(stalled), "--hostile", str(hostile), "--seconds", str(seconds))
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, *_CROWD, str(it.gateway.address), *counts),
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        cwd=_ROOT,
    )
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(f"{it.gateway.secret}\n".encode())
    process.stdin.close()
    ready = await process.stdout.readline()
    assert ready == b"half\n", ready
    meter = Meter(it)
    told = await process.stdout.readline()
    cost = meter.read()
    await process.wait()
    return CrowdSeen(**json.loads(told)), cost


async def idle(it: House, seconds: float) -> Cost:
    """Return what both take while nobody looks."""
    meter = Meter(it)
    await asyncio.sleep(seconds)
    return meter.read()


def cpu_s(pid: int) -> float:
    """Return the processor time of a process, of all its threads [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS_PER_S


def _resident_mib(pid: int) -> float:
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * _PAGE_MIB


def _family(pid: int) -> list[int]:
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [pid, *(one for child in children for one in _family(int(child)))]
