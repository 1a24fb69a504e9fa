"""A replay gives the daemon the same bytes, commands and computing times, in the same order."""

import asyncio
from pathlib import Path

import pytest

from robotd.core.clock import now_ns
from robotd.core.errors import TransportError
from robotd.recording.comparison import compare, results_digest
from robotd.recording.entries import (
    CAUSES_ARE_NOTED,
    CauseEntry,
    CommandEntry,
    ComputedEntry,
    LineEntry,
)
from robotd.recording.moments import run_recorded
from robotd.recording.playback import Playback, RecordedCompute
from robotd.recording.reader import read
from robotd.recording.recorder import Recorder
from tests.support.memory_journal import MemoryJournal
from tests.unit.recording.toy_daemon import (
    HEADER,
    WORDS,
    ToyDaemon,
    from_board,
    live_run,
    no_command,
    recorded,
    recording_of,
    replay,
)


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


def test_waiting_for_what_never_comes_is_an_error() -> None:
    async def wait_for_ever() -> None:
        await asyncio.Event().wait()

    with pytest.raises(RuntimeError, match="stuck"):
        run_recorded(wait_for_ever(), start_ns=0)


async def test_a_recording_is_not_played_on_another_loop() -> None:
    with pytest.raises(TypeError, match="use run_recorded"):
        await Playback(recording_of(), no_command).run()
