"""A loop that stands still stops the robot from another thread, in real time."""

import asyncio
import threading
import time

import pytest

from robotd.app.callbacks import stopping_on_errors
from robotd.app.stall_guard import STALL_S, _Guard, guarded
from robotd.core.attention import attention
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.pty import open_pty
from robotd.hardware.transport.serial_port import open_serial


def always() -> bool:
    return True


def never_called(before: int) -> None:
    raise AssertionError("nothing was to be stopped")


@pytest.mark.real_clock
async def test_a_stuck_loop_gets_the_stop_onto_the_wire_while_it_is_stuck() -> None:
    board, told = open_pty(), asyncio.Event()
    line = await open_serial(board.path, LineFormat(115_200))
    stopped = threading.Event()

    def stop(before: int) -> None:
        if not before:
            line.write_past_loop(b"stop")
            stopped.set()

    async with guarded(always, stop, lambda *_: told.set()):
        await asyncio.sleep(0)  # the first beat
        began_s = time.monotonic()
        assert stopped.wait(60.0), "the guard did nothing"  # blocks the loop, which is the point
        assert time.monotonic() - began_s >= STALL_S / 2
        assert await board.read() == b"stop"
        await asyncio.wait_for(told.wait(), 10.0)
    line.close()
    board.close()


@pytest.mark.real_clock
async def test_a_loop_that_turns_is_left_alone_and_each_stall_is_told_once() -> None:
    asked: list[str] = []
    stops: list[str] = []
    stalls: list[tuple[float, bool, str]] = []

    def once() -> bool:
        asked.append("must it stop?")
        return len(asked) == 1  # the second time there is nothing to stop

    def stop(before: int) -> None:
        if before == 0:
            stops.append("stop")

    async with guarded(once, stop, lambda *stall: stalls.append(stall)):
        await asyncio.sleep(0)
        for count in (1, 2):
            time.sleep(3 * STALL_S)  # noqa: ASYNC251  # a loop that is stuck
            await asyncio.sleep(STALL_S / 8)
            assert (len(asked), len(stalls)) == (count, count)
    assert stops == ["stop"]
    assert all(stood_still_s > STALL_S and "time.sleep" in where for stood_still_s, _, where in stalls)
    assert [was_stopped for _, was_stopped, _ in stalls] == [True, False]
    assert attention().missed_s == 0.0  # for those who are told to add up


async def test_a_stop_is_told_with_what_the_thread_waited_though_the_loop_told_of_the_stall_before() -> None:
    """A process that stood still wakes as a whole: now the loop is first to see it, now the thread."""
    stalls: list[tuple[float, bool]] = []
    guard = _Guard(
        always, never_called, lambda stood_still_s, was_stopped, _: stalls.append((stood_still_s, was_stopped))
    )
    guard._due_s = asyncio.get_running_loop().time() - 5.0
    guard.look()
    guard._has_stopped.set()
    guard.look()
    guard.look()
    assert stalls == [(5.0, False), (STALL_S, True)]


@pytest.mark.real_clock
async def test_whoever_reads_first_after_a_stall_finds_it_noted() -> None:
    stalls: list[float] = []
    async with guarded(lambda: False, never_called, lambda stood_still_s, *_: stalls.append(stood_still_s)):
        await asyncio.sleep(0)
        time.sleep(STALL_S)  # noqa: ASYNC251  # a loop that is stuck
        attention().look()
        assert len(stalls) == 1
        attention().look()
        assert len(stalls) == 1


@pytest.mark.real_clock
async def test_what_a_stop_leads_to_is_read_as_its_work_though_the_thread_is_not_done_with_it() -> None:
    """On a busy machine the thread waits for its turn between the wires, and boards answer sooner."""
    stalls: list[tuple[bool, bool]] = []
    writing, read = threading.Event(), threading.Event()

    def stop(before: int) -> None:
        writing.set()
        read.wait(10.0)

    async with guarded(always, stop, lambda _, was_stopped, __: stalls.append((was_stopped, read.is_set()))):
        await asyncio.sleep(0)
        assert writing.wait(10.0)  # blocks the loop, which is the point
        attention().look()  # as who reads does, before anything is made of what was read
        assert stalls == [(True, False)]
        read.set()


@pytest.mark.real_clock
async def test_a_question_that_fails_is_a_reason_to_stop(caplog: pytest.LogCaptureFixture) -> None:
    said: list[int] = []

    def fails() -> bool:
        raise ZeroDivisionError("a mistake")

    async with guarded(fails, said.append, lambda *_: None):
        await asyncio.sleep(0)
        time.sleep(2 * STALL_S)  # noqa: ASYNC251  # a loop that is stuck
        await asyncio.sleep(STALL_S / 4)
    assert said[0] == 0
    assert any("cannot be said" in message for message in caplog.messages)


@pytest.mark.real_clock
async def test_a_stop_that_fails_is_told_and_the_next_stall_is_seen_all_the_same(
    caplog: pytest.LogCaptureFixture,
) -> None:
    asked: list[int] = []
    stalls: list[str] = []

    def stop(before: int) -> None:
        asked.append(before)
        raise OSError("no way to the wire")

    async with guarded(always, stop, lambda *_: stalls.append("stall")):
        for count in (1, 2):
            await asyncio.sleep(STALL_S / 2)
            time.sleep(2 * STALL_S)  # noqa: ASYNC251  # a loop that is stuck
            await asyncio.sleep(STALL_S / 2)
            assert (asked.count(0), len(stalls)) == (count, count)
    assert any("could not be stopped past the loop" in message for message in caplog.messages)


@pytest.mark.real_clock
async def test_the_stop_is_said_again_until_the_loop_turns_and_then_no_more() -> None:
    said: list[int] = []

    async with guarded(always, said.append, lambda *_: None):
        await asyncio.sleep(0)
        time.sleep(3 * STALL_S)  # noqa: ASYNC251  # a loop that is stuck
        await asyncio.sleep(STALL_S / 4)
        count = len(said)
        assert count > 3
        assert said == list(range(count))
        await asyncio.sleep(STALL_S)
        assert len(said) == count


@pytest.mark.real_clock
async def test_a_closed_line_takes_no_stop_from_a_thread() -> None:
    board = open_pty()
    line = await open_serial(board.path, LineFormat(115_200))
    line.close()
    line.write_past_loop(b"stop")
    board.close()


@pytest.mark.real_clock
async def test_a_mistake_in_what_is_told_stops_the_robot_and_ends_neither_the_beat_nor_the_reader() -> None:
    stalls: list[float] = []
    halts: list[str] = []

    def stalled(stood_still_s: float, was_stopped: bool, where: str) -> None:
        stalls.append(stood_still_s)
        raise ZeroDivisionError("a mistake")

    with stopping_on_errors(halts.append):
        async with guarded(lambda: False, never_called, stalled):
            await asyncio.sleep(0)
            time.sleep(STALL_S)  # noqa: ASYNC251  # a loop that is stuck
            attention().look()
            assert len(stalls) == 1
            time.sleep(2 * STALL_S)  # noqa: ASYNC251  # as above
            await asyncio.sleep(STALL_S)
            assert len(stalls) >= 2
    assert halts[0] == "internal error: ZeroDivisionError('a mistake')"
    assert len(halts) == len(stalls)
