"""Children that are processes: killed, stopped, hungry, and orphaned."""

import asyncio
import contextlib
import errno
import os
import pty
import resource
import signal
import socket
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Sequence
from pathlib import Path

import pytest

import robotd
from robotd.children import landlock
from robotd.children.channel import Channel
from robotd.children.child import Child, Death
from robotd.children.pings import Patience
from robotd.children.process import Process, Program, spawn
from robotd.core.errors import ChildError

pytestmark = pytest.mark.real_clock
ECHO = (str(Path(__file__).with_name("an_echo.py")),)
PATIENCE = Patience(ready_s=60.0)


UNCONFINED = f"""
import runpy
from robotd.children import landlock
landlock._CREATE_RULESET = -1  # no kernel has that system call
runpy.run_path({ECHO[0]!r}, run_name="__main__")
"""


def landlock_refuses_all() -> bool:
    """Whether the kernel knows how to refuse signals, the last thing that it learned of what is asked for."""
    try:
        return landlock.version() >= 6
    except OSError:
        return False


class Echo:
    """An echo that is always there."""

    def __init__(self, sockets_in: str) -> None:
        self.sockets_in = sockets_in
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
        self.processes.append(spawn(Program(ECHO, memory_bytes=2**29, sockets_in=self.sockets_in)))
        return self.processes[-1]

    async def _serve(self, lanes: Sequence[Channel]) -> None:
        (self.lane,) = lanes
        await asyncio.Event().wait()

    async def says(self, message: bytes) -> bytes:
        await self.child.is_ready.wait()
        self.lane.send(message)
        return bytes(await self.lane.receive())


@contextlib.asynccontextmanager
async def an_echo(sockets_in: str = "") -> AsyncIterator[Echo]:
    echo = Echo(sockets_in)
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
        assert (await echo.deaths.get()).cause == "it was silent for 0.3 s"
        assert await echo.says(b"and again") == b"and again"
        echo.lane.send(b"hang")
        assert (await echo.deaths.get()).cause == "it was silent for 0.3 s"
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


async def test_it_shares_no_session_with_what_must_have_its_turn_before_it() -> None:
    async with an_echo() as echo:
        await echo.child.is_ready.wait()
        pid = echo.processes[-1].pid
        assert os.getsid(pid) == pid != os.getsid(0)


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


@pytest.mark.parametrize(
    ("error", "why"),
    [
        (OSError(errno.ENOMEM, os.strerror(errno.ENOMEM)), "Cannot allocate memory"),
        (BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN)), "Resource temporarily unavailable"),
        (MemoryError(), "no memory"),
    ],
)
async def test_without_memory_or_processes_it_cannot_be_started_and_no_descriptor_is_lost(
    monkeypatch: pytest.MonkeyPatch, error: Exception, why: str
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("robotd.children.process.subprocess.Popen", refuse)
    before = open_descriptors()
    with pytest.raises(ChildError, match=f"it cannot be started: .*{why}"):
        spawn(Program(ECHO, lanes=2))
    assert open_descriptors() == before


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


@pytest.mark.skipif(not landlock_refuses_all(), reason="the kernel cannot keep a child from all of this")
async def test_it_reaches_its_program_and_its_sockets_and_nothing_else_of_this_machine(tmp_path: Path) -> None:
    run, maps = tmp_path / "run", tmp_path / "maps"
    run.mkdir()
    maps.mkdir()
    (maps / "cells.bin").write_bytes(b"a map")
    (run / "old.sock").touch()
    board, line = pty.openpty()
    with socket.create_server(("127.0.0.1", 0)) as elsewhere:
        refused = {
            f"open {os.ttyname(line)}",
            "read /dev/null",
            "list /dev",
            "read /proc/self/mem",
            *(f"{what} {maps / 'cells.bin'}" for what in ("read", "write", "remove", "rename", "truncate")),
            f"list {maps}",
            f"listen {maps / 'a.sock'}",
            f"write {run / 'a file'}",
            f"run {sys.executable}",
            f"signal {os.getpid()}",
            f"connect {elsewhere.getsockname()[1]}",
        }
        allowed = {f"read {robotd.__file__}", f"listen {run / 'new.sock'}", f"remove {run / 'old.sock'}"}
        async with an_echo(str(run)) as echo:
            answers = {asked: await echo.says(f"try {asked}".encode()) for asked in refused | allowed}
    os.close(board)
    os.close(line)
    assert {asked for asked, answer in answers.items() if answer == b"done"} == allowed
    assert (maps / "cells.bin").read_bytes() == b"a map"


async def test_it_gives_up_the_real_time_that_its_parent_may_have() -> None:
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        pytest.skip("no real time for this user")
    try:
        child = spawn(Program(ECHO))
    finally:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    await child.life.receive()  # it is ready
    threads = os.listdir(f"/proc/{child.pid}/task")  # noqa: PTH208  # numbers are what is wanted
    assert {os.sched_getscheduler(int(thread)) for thread in threads} == {os.SCHED_OTHER}
    child.kill()
    await child.ended()
    child.close()


async def test_where_the_kernel_does_not_confine_it_that_is_said_and_it_serves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A filter of system calls, as a service may have it, refuses what the kernel would do."""
    monkeypatch.setattr(sys.modules[__name__], "ECHO", ("-c", UNCONFINED))
    async with an_echo() as echo:
        assert await echo.says(b"unconfined") == b"Function not implemented"


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
