"""The loop goes on turning however long the kernel takes to say whether a line can be read."""

import asyncio
import select
import socket
import threading
import time
from collections.abc import Callable

import pytest

from robotd.hardware.transport.descriptor_readiness import InThread, OnLoop, Readiness
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.pty import open_pty
from robotd.hardware.transport.serial_port import open_serial

pytestmark = pytest.mark.real_clock

SLOW_S = 0.3


class SlowPoll:
    """A kernel whose worker for terminals does not get its turn."""

    def __init__(self) -> None:
        self._poll = POLL()

    def register(self, descriptor: int, events: int) -> None:
        self._poll.register(descriptor, events)

    def unregister(self, descriptor: int) -> None:
        self._poll.unregister(descriptor)

    def poll(self) -> list[tuple[int, int]]:
        time.sleep(SLOW_S)
        return self._poll.poll()


POLL = select.poll


def watchers() -> set[str]:
    return {thread.name for thread in threading.enumerate() if thread.name.startswith("watch ")}


async def test_the_loop_turns_while_the_kernel_keeps_who_asks_about_a_line_waiting(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    board = open_pty()
    monkeypatch.setattr("robotd.hardware.transport.descriptor_readiness.select.poll", SlowPoll)
    line = await open_serial(board.path, LineFormat(115_200))
    reading = asyncio.create_task(line.read())
    board.write(b"late")
    turns = 0
    while not reading.done():
        await asyncio.sleep(0.001)
        turns += 1
    assert await reading == b"late"
    assert turns >= 20  # it was asked for 0.3 s at least
    line.close()
    board.close()


@pytest.mark.parametrize("kind", [OnLoop, lambda descriptor: InThread("pair", descriptor)], ids=["loop", "thread"])
async def test_each_wish_is_told_once_and_what_is_forgotten_is_not(kind: Callable[[int], Readiness]) -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        ours.setblocking(False)
        told: list[str] = []
        ready = kind(ours.fileno())
        ready.when_readable(lambda: told.append("forgotten"))
        ready.forget_readable()
        theirs.send(b"x")
        await asyncio.sleep(0.05)
        assert told == []
        ready.when_readable(lambda: told.append("readable"))
        ready.when_writable(lambda: told.append("writable"))
        await asyncio.sleep(0.05)
        assert sorted(told) == ["readable", "writable"]
        await asyncio.sleep(0.05)
        assert len(told) == 2  # though it still is both
        ready.when_readable(lambda: told.append("again"))
        await asyncio.sleep(0.05)
        assert told[2:] == ["again"]
        ready.close()
        ready.close()
        await asyncio.sleep(0.05)
        assert watchers() == set()


async def test_a_line_nobody_waits_for_costs_nothing_though_it_hung_up() -> None:
    board = open_pty()
    line = await open_serial(board.path, LineFormat(115_200))
    board.close()
    began_s = time.process_time()
    await asyncio.sleep(0.2)
    assert time.process_time() - began_s < 0.1
    line.close()


async def test_many_lines_come_and_go_and_leave_no_thread() -> None:
    for _ in range(50):
        board = open_pty()
        line = await open_serial(board.path, LineFormat(115_200))
        reading = asyncio.create_task(line.read())
        board.write(b"?")
        assert await reading == b"?"
        line.close()
        board.close()
    await asyncio.sleep(0.1)
    assert watchers() == set()
