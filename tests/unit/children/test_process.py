"""Children that are processes: killed, stopped, hungry, and orphaned."""

import asyncio
import contextlib
import os
import resource
import signal
import socket
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Sequence
from pathlib import Path

import pytest

from robotd.children.channel import Channel
from robotd.children.child import Child, Death
from robotd.children.pings import Patience
from robotd.children.process import Process, Program, spawn
from robotd.core.errors import ChildError

pytestmark = pytest.mark.real_clock
ECHO = (str(Path(__file__).with_name("an_echo.py")),)
PATIENCE = Patience(ready_s=60.0, silent_s=1.0)


class Echo:
    """An echo that is always there."""

    def __init__(self) -> None:
        self.deaths: asyncio.Queue[Death] = asyncio.Queue()
        self.processes: list[Process] = []
        self.lane: Channel
        self.child = Child(
            "echo",
            "1.0",
            start=self._start,
            serve=self._serve,
            died=self.deaths.put_nowait,
            patience=PATIENCE,
        )

    def _start(self) -> Process:
        self.processes.append(spawn(Program(ECHO, memory_bytes=2**29)))
        return self.processes[-1]

    async def _serve(self, lanes: Sequence[Channel]) -> None:
        (self.lane,) = lanes
        await asyncio.Event().wait()

    async def says(self, message: bytes) -> bytes:
        await self.child.is_ready.wait()
        self.lane.send(message)
        return await self.lane.receive()


@contextlib.asynccontextmanager
async def an_echo() -> AsyncIterator[Echo]:
    echo = Echo()
    running = asyncio.create_task(echo.child.run())
    try:
        async with asyncio.timeout(60.0):
            await echo.child.is_ready.wait()
            yield echo
    finally:
        running.cancel()
        await asyncio.wait((running,))
        assert not any(is_alive(process.pid) for process in echo.processes)


def open_descriptors() -> int:
    return sum(1 for _ in Path("/proc/self/fd").iterdir())


def is_alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


async def test_it_is_killed_or_stopped_or_hangs_or_ends_and_another_one_is_there() -> None:
    async with an_echo() as echo:
        assert await echo.says(b"hello") == b"hello"
        os.kill(echo.processes[-1].pid, signal.SIGKILL)
        assert (await echo.deaths.get()).cause == "it was ended by SIGKILL"
        assert await echo.says(b"again") == b"again"
        os.kill(echo.processes[-1].pid, signal.SIGSTOP)
        assert (await echo.deaths.get()).cause == "it was silent for 1 s"
        assert await echo.says(b"and again") == b"and again"
        echo.lane.send(b"hang")
        assert (await echo.deaths.get()).cause == "it was silent for 1 s"
        await echo.says(b"still there")
        echo.lane.send(b"exit")
        assert (await echo.deaths.get()).cause == "it ended with exit code 3"


async def test_it_has_its_lanes_and_no_other_descriptor_of_ours_and_no_memory_without_end() -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        ours.set_inheritable(True)
        async with an_echo() as echo:
            numbers = set((await echo.says(b"descriptors")).split())
            assert str(ours.fileno()).encode() not in numbers
            assert await echo.says(b"eat") == b"no memory"
            assert await echo.says(b"well") == b"well"


async def test_signals_of_a_terminal_do_not_end_it() -> None:
    async with an_echo() as echo:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            os.kill(echo.processes[-1].pid, number)
        assert await echo.says(b"hello") == b"hello"
        assert echo.deaths.empty()


async def test_what_cannot_be_started_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(ChildError, match=r"it cannot be started: .*No such file"):
        spawn(Program(ECHO))


async def test_without_descriptors_it_cannot_be_started_and_none_is_lost() -> None:
    before = open_descriptors()
    os.close(lowest := os.dup(0))
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (lowest + 3, hard))
    try:
        with pytest.raises(ChildError, match=r"it cannot be started: .*Too many open files"):
            spawn(Program(ECHO, lanes=20))
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    assert open_descriptors() == before


def test_no_child_outlives_its_parent_whatever_it_is_at() -> None:
    """A parent that is ended cannot end it; a child that hangs does not see that it was hung up on."""
    program = f"""
import asyncio
from robotd.children.process import Program, spawn
async def main():
    child = spawn(Program({ECHO!r}))
    await child.life.receive()
    child.lanes[0].send(b"hang")
    print(child.pid, flush=True)
    await asyncio.sleep(1000)
asyncio.run(main())
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        pid = int(parent.stdout.readline())
        assert is_alive(pid)
        parent.kill()
        parent.wait()
    until_s = time.monotonic() + 10.0
    while is_alive(pid):
        assert time.monotonic() < until_s
