"""Timers in a replay: what they did when it was recorded they do again, at its time, and nothing else."""

import asyncio

from robotd.core.clock import now_ns
from robotd.hardware.link.tap import Direction
from robotd.recording.entries import (
    BytesEntry,
    LineEntry,
)
from robotd.recording.journal import Journal
from robotd.recording.playback import Playback
from tests.support.memory_journal import MemoryJournal
from tests.unit.recording.toy_daemon import (
    from_board,
    no_command,
    recorded,
    recording_of,
)


async def ask_with_patience(playback: Playback, patience_s: float, journal: Journal) -> int:
    """Ask again whenever there is no answer in time; return how often."""
    line = await playback.line("drive").connect()
    reading = asyncio.create_task(line.read())
    for tries in range(1, 10):
        journal.bytes_passed("drive", Direction.TO_BOARD, now_ns(), b"ask;")
        line.write(b"ask;")
        done, _ = await asyncio.wait({reading}, timeout=patience_s)
        if done:
            return tries
    raise AssertionError("never answered")


@recorded
async def test_a_timer_that_did_nothing_when_it_was_recorded_does_nothing_in_the_replay() -> None:
    start = now_ns()
    answer = from_board(start + 500_000_000, b"late, but the daemon was even later")
    playback = Playback(recording_of(LineEntry(start + 1, "drive", up=True), answer), no_command)
    asking = asyncio.create_task(ask_with_patience(playback, 0.2, MemoryJournal()))
    await playback.run()
    assert await asking == 1


@recorded
async def test_what_comes_at_a_moment_has_its_whole_effect_before_a_timer_that_is_due() -> None:
    start = now_ns()
    playback = Playback(
        recording_of(LineEntry(start, "drive", up=True), from_board(start + 500_000_000, b"late")), no_command
    )
    items: asyncio.Queue[bytes] = asyncio.Queue()

    async def pass_on() -> None:
        line = await playback.line("drive").connect()
        items.put_nowait(await line.read())

    async def use() -> bytes:
        async with asyncio.timeout(0.1):
            item = await items.get()
            for _ in range(20):
                await asyncio.sleep(0)
            return item

    passing, using = asyncio.create_task(pass_on()), asyncio.create_task(use())
    await playback.run()
    await passing
    assert await using == b"late"


@recorded
async def test_without_moments_timers_fire_in_their_order_at_their_times() -> None:
    start, order = now_ns(), list[tuple[str, int]]()
    loop = asyncio.get_running_loop()
    for name, after_s in (("c", 0.3), ("a", 0.1), ("b", 0.2), ("a2", 0.1)):
        loop.call_at(loop.time() + after_s, lambda name=name: order.append((name, now_ns() - start)))  # type: ignore[misc]  # a lambda with a default
    loop.call_later(0.15, order.append, ("cancelled", 0)).cancel()
    await asyncio.sleep(0.25)
    assert order == [("a", 100_000_000), ("a2", 100_000_000), ("b", 200_000_000)]
    await asyncio.sleep(0.1)
    assert order[3:] == [("c", 300_000_000)]


@recorded
async def test_a_timer_that_did_something_does_it_again_at_its_time() -> None:
    start = now_ns()
    asked = [BytesEntry(start + ms * 1_000_000, "drive", Direction.TO_BOARD, b"ask;") for ms in (0, 203, 411)]
    answer = from_board(start + 500_000_000, b"late")
    recording = recording_of(LineEntry(start, "drive", up=True), *asked, answer)
    playback, journal = Playback(recording, no_command), MemoryJournal()
    asking = asyncio.create_task(ask_with_patience(playback, 0.2, journal))
    await playback.run()
    assert await asking == 3
    assert [entry.time_ns for entry in journal.entries] == [entry.time_ns for entry in asked]
    assert now_ns() > answer.time_ns
