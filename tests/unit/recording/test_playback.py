"""A replay gives the daemon the same bytes, commands and computing times, in the same order."""

import asyncio
import functools
import random
import zlib
from collections.abc import Awaitable, Callable, Coroutine
from pathlib import Path
from typing import Any

import pytest

from robotd.core.clock import now_ns, run_virtual
from robotd.core.errors import TransportError
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.memory import MemoryEnd, memory_pair
from robotd.hardware.transport.transport import Connect, Transport
from robotd.hardware.wire.word import Repeat, Word
from robotd.recording.comparison import compare, results_digest
from robotd.recording.entries import (
    CAUSES_ARE_NOTED,
    BytesEntry,
    CauseEntry,
    CommandEntry,
    ComputedEntry,
    Entry,
    LineEntry,
    RecordingHeader,
)
from robotd.recording.journal import Journal
from robotd.recording.moments import run_recorded
from robotd.recording.playback import Playback, RecordedCompute
from robotd.recording.reader import Recording, read
from robotd.recording.recorder import Recorder
from tests.support.memory_journal import MemoryJournal

START_NS = 5_000_000_000
HEADER = RecordingHeader("0.1.0", "", 1, 0, START_NS)
DEVICES = ("drive", "laser")


def recording_of(*entries: Entry) -> Recording:
    return Recording(HEADER, entries)


def from_board(time_ns: int, data: bytes, device: str = "drive") -> BytesEntry:
    return BytesEntry(time_ns, device, Direction.FROM_BOARD, data)


def no_command(entry: CommandEntry) -> None:
    pytest.fail(f"unexpected {entry}")


class SlowCompute:
    """Takes its time, one job after the other, and notes when each is done."""

    def __init__(self, journal: Journal, chance: random.Random) -> None:
        self.journal = journal
        self.chance = chance
        self.done = 0
        self.worker = asyncio.Lock()

    async def run(self, name: str, function: Callable[..., Any], *args: object) -> Any:
        async with self.worker:
            await asyncio.sleep(self.chance.uniform(0.001, 0.03))
        result = function(*args)
        self.journal.computed(now_ns(), name, self.done)
        self.done += 1
        return result


class ToyDaemon:
    """Sums what the boards say; what it asks and finds depends on every byte and on their order."""

    def __init__(self, connects: dict[str, Connect], compute: Any, journal: Journal) -> None:
        self.connects = connects
        self.compute = compute
        self.journal = journal
        self.seen = 0

    async def serve(self, device: str) -> None:
        while True:
            line = await self.connects[device]()
            self.journal.line_changed(device, now_ns(), up=True)
            try:
                await self.serve_line(device, line)
            except TransportError:
                self.journal.line_changed(device, now_ns(), up=False)
                await asyncio.sleep(0.05)

    async def serve_line(self, device: str, line: Transport) -> None:
        self.ask(device, line, b"hello;")
        while True:
            data = await line.read()
            self.journal.bytes_passed(device, Direction.FROM_BOARD, now_ns(), data)
            self.seen = zlib.crc32(device.encode() + data, self.seen) % 1000
            total = await self.compute.run("sum", int, self.seen)
            self.journal.result(now_ns(), "total", {"total": total}, str(total))
            self.ask(device, line, f"{total};".encode())

    def ask(self, device: str, line: Transport, data: bytes) -> None:
        self.journal.bytes_passed(device, Direction.TO_BOARD, now_ns(), data)
        line.write(data)

    def command(self, name: str) -> None:
        self.journal.command(now_ns(), name, {})
        self.seen += 1

    async def run(self, outside: Callable[[], Awaitable[None]]) -> None:
        async with asyncio.TaskGroup() as tasks:
            servers = [tasks.create_task(self.serve(device)) for device in DEVICES]
            await outside()
            for server in servers:
                server.cancel()


def live_run(seed: int, journal: Journal) -> None:
    """Run the toy daemon on talkative boards whose lines are cut now and then."""
    chance = random.Random(seed)
    ends: dict[str, MemoryEnd] = {}

    async def connect(device: str) -> Transport:
        await asyncio.sleep(chance.uniform(0.0, 0.01))
        near, ends[device] = memory_pair(device)
        return near

    async def main() -> None:
        connects: dict[str, Connect] = {device: functools.partial(connect, device) for device in DEVICES}
        daemon = ToyDaemon(connects, SlowCompute(journal, chance), journal)

        async def outside() -> None:
            for number in range(60):
                await asyncio.sleep(chance.uniform(0.0, 0.03))
                device = chance.choice(DEVICES)
                if number % 20 == 7:
                    daemon.command("poke")
                elif device in ends and number % 25 == 24:
                    ends[device].cut()
                elif device in ends:
                    try:
                        ends[device].write(bytes([number]))
                    except TransportError:
                        continue

        await daemon.run(outside)

    run_virtual(main(), start_ns=START_NS)


def replay(recording: Recording) -> list[Entry]:
    journal = MemoryJournal()

    async def main() -> None:
        daemon: ToyDaemon
        playback = Playback(recording, lambda entry: daemon.command(entry.name))
        daemon = ToyDaemon({device: playback.line(device).connect for device in DEVICES}, playback.compute, journal)
        await daemon.run(playback.run)

    run_recorded(main(), start_ns=recording.header.started_ns)
    return journal.entries


def in_words(data: bytes) -> list[Word]:
    return [Word(text, Repeat.UNTIL_OBEYED) for text in data.decode().split(";")[:-1]]


WORDS = dict.fromkeys(DEVICES, in_words)


@pytest.mark.parametrize("seed", range(5))
def test_a_replay_asks_and_finds_what_the_live_run_did(tmp_path: Path, seed: int) -> None:
    recorder = Recorder(tmp_path / "a.mcap", HEADER)
    live_run(seed, recorder)
    recorder.close()
    recording = read(tmp_path / "a.mcap")
    assert len(recording.results) > 20
    first, second = replay(recording), replay(recording)
    assert compare(recording, first, WORDS) == ()
    assert first == second
    assert results_digest(first) == results_digest(second)


def test_a_daemon_that_thinks_otherwise_is_found_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    journal = MemoryJournal()
    live_run(3, journal)
    recording = recording_of(*journal.entries)
    really = ToyDaemon.ask
    monkeypatch.setattr(ToyDaemon, "ask", lambda self, device, line, data: really(self, device, line, b"x" + data))
    differences = compare(recording, replay(recording), WORDS)
    assert [difference.device for difference in differences] == ["laser", "drive"]
    assert (differences[0].expected, differences[0].actual) == ("hello", "xhello")


@pytest.mark.parametrize("keep", [0.2, 0.5, 0.8])
def test_a_cut_recording_replays_up_to_the_cut(keep: float) -> None:
    journal = MemoryJournal()
    live_run(4, journal)
    recording = recording_of(*journal.entries[: int(keep * len(journal.entries))])
    assert compare(recording, replay(recording), WORDS) == ()


def recorded(test: Callable[[], Coroutine[Any, Any, None]]) -> Callable[[], None]:
    """Run a test on a loop that can be led through recorded moments."""

    @functools.wraps(test)
    def run() -> None:
        run_recorded(test(), start_ns=START_NS)

    del run.__wrapped__  # pytest would see the coroutine function through it
    return run


@recorded
async def test_chunks_arrive_as_they_were_at_their_times() -> None:
    start = now_ns()
    playback = Playback(
        recording_of(
            LineEntry(start + 10, "drive", up=True),
            from_board(start + 20, b"ab"),
            from_board(start + 20, b"c"),
            LineEntry(start + 30, "drive", up=False),
            LineEntry(start + 40, "drive", up=True),
            from_board(start + 50, b"d"),
        ),
        no_command,
    )
    task = asyncio.create_task(playback.run())
    line = playback.line("drive")
    first = await line.connect()
    assert now_ns() == start + 10
    first.write(b"anything")
    assert (await first.read(), now_ns()) == (b"ab", start + 20)
    assert (await first.read(), now_ns()) == (b"c", start + 20)
    with pytest.raises(TransportError, match="lost in the recording"):
        await first.read()
    assert now_ns() == start + 30
    with pytest.raises(TransportError):
        first.write(b"too late")
    second = await line.connect()
    assert now_ns() == start + 40
    assert await second.read() == b"d"
    second.close()
    second.close()
    with pytest.raises(TransportError, match="closed"):
        await second.read()
    await task


@recorded
async def test_a_daemon_that_connects_late_still_gets_every_byte() -> None:
    playback = Playback(
        recording_of(LineEntry(1, "drive", up=True), from_board(2, b"a"), from_board(3, b"b")), no_command
    )
    await playback.run()
    line = await playback.line("drive").connect()
    assert [await line.read(), await line.read()] == [b"a", b"b"]


@recorded
async def test_closing_ends_a_pending_read() -> None:
    playback = Playback(recording_of(LineEntry(1, "drive", up=True)), no_command)
    await playback.run()
    line = await playback.line("drive").connect()
    reading = asyncio.create_task(line.read())
    await asyncio.sleep(0)
    line.close()
    with pytest.raises(TransportError):
        await reading


@recorded
async def test_a_line_that_was_never_opened_never_comes() -> None:
    playback = Playback(recording_of(), no_command)
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(1000):
            await playback.line("drive").connect()


@recorded
async def test_commands_come_at_their_times() -> None:
    start = now_ns()
    seen: list[tuple[int, str]] = []
    entries = [CommandEntry(start + 5, "arm", {}), CommandEntry(start + 9, "stop", {"reason": "x"})]
    await Playback(recording_of(*entries), lambda entry: seen.append((now_ns(), entry.name))).run()
    assert seen == [(start + 5, "arm"), (start + 9, "stop")]


@recorded
async def test_results_of_computing_come_no_earlier_than_recorded_and_in_order() -> None:
    start = now_ns()
    playback = Playback(
        recording_of(ComputedEntry(start + 100, "rank", 0), ComputedEntry(start + 500, "rank", 1)), no_command
    )
    task = asyncio.create_task(playback.run())
    done: list[tuple[int, int]] = []

    async def job(number: int) -> None:
        done.append((await playback.compute.run("rank", lambda: number), now_ns() - start))

    await asyncio.gather(job(0), job(1), job(2))
    assert done[:2] == [(0, 100), (1, 500)]
    assert done[2][0] == 2
    assert done[2][1] > 500, "a job that the recording does not see done is done after its end"
    await task


@recorded
async def test_a_job_that_was_none_when_it_was_recorded_takes_no_time() -> None:
    begun = CauseEntry(1, CAUSES_ARE_NOTED, {})
    old = RecordedCompute(recording_of(ComputedEntry(5, "insert", 0)))
    new = RecordedCompute(recording_of(begun, ComputedEntry(5, "begin map", 0)))
    assert await old.run("begin map", lambda: 7) == 7
    waiting = asyncio.create_task(new.run("begin map", lambda: 7))
    await asyncio.sleep(0)
    assert not waiting.done()
    new.release(ComputedEntry(5, "begin map", 0))
    assert await waiting == 7


@recorded
async def test_a_map_whose_beginning_was_stopped_never_begins() -> None:
    compute = RecordedCompute(recording_of(CauseEntry(1, CAUSES_ARE_NOTED, {})))
    waiting = asyncio.create_task(compute.run("begin map", lambda: 7))
    await asyncio.sleep(1.0)
    assert not waiting.done()
    compute.release_all()
    assert await waiting == 7


@recorded
async def test_a_job_that_fails_or_is_cancelled_does_not_count() -> None:
    compute = RecordedCompute(recording_of(ComputedEntry(5, "rank", 0)))
    with pytest.raises(ZeroDivisionError):
        await compute.run("rank", lambda: 1 // 0)
    cancelled = asyncio.create_task(compute.run("rank", int))
    await asyncio.sleep(0)
    cancelled.cancel()
    compute.release(ComputedEntry(5, "rank", 0))
    assert await compute.run("rank", lambda: 7) == 7


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


def test_waiting_for_what_never_comes_is_an_error() -> None:
    async def wait_for_ever() -> None:
        await asyncio.Event().wait()

    with pytest.raises(RuntimeError, match="stuck"):
        run_recorded(wait_for_ever(), start_ns=0)


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


async def test_a_recording_is_not_played_on_another_loop() -> None:
    with pytest.raises(TypeError, match="use run_recorded"):
        await Playback(recording_of(), no_command).run()
