"""Two inputs whose effects interleave: a replay interleaves them as they did."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import pytest

from robotd.app.replaying import check_recorded
from robotd.core.clock import now_ns, run_virtual
from robotd.core.errors import RecordingError
from robotd.hardware.link.tap import Direction
from robotd.hardware.link.tapped import TappedLine
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.transport.transport import Connect, Transport
from robotd.recording.encoding import decode, encode
from robotd.recording.entries import STALL, BytesEntry, Entry, RecordingHeader, TurnEntry
from robotd.recording.journal import Journal
from robotd.recording.moments import run_recorded
from robotd.recording.playback import Playback
from robotd.recording.reader import Recording, read
from robotd.recording.recorder import Recorder
from tests.support.memory_journal import MemoryJournal

HEADER = RecordingHeader("0.1.0", "", 1, 0, 0)
STEPS = 4


async def serve(device: str, connect: Connect, journal: Journal, seen: list[str]) -> None:
    """Take some turns over every chunk, as a daemon of many tasks does."""
    line = TappedLine(device, await connect(), journal)
    while True:
        chunk = await line.read()
        for step in range(STEPS):
            seen.append(f"{device}{step} at {chunk.time_ns}")
            await asyncio.sleep(0)


def live(order: str, turns: int, apart_ns: int) -> tuple[list[Entry], list[str]]:
    """Give bytes to two lines, some turns apart, and return what was noted and in which order it had its effects."""

    async def main() -> tuple[list[Entry], list[str]]:
        journal, seen = MemoryJournal(), list[str]()
        pairs = {device: memory_pair(device) for device in "ab"}

        def connect_to(device: str) -> Connect:
            async def connect() -> Transport:
                return pairs[device][0]

            return connect

        tasks = [asyncio.create_task(serve(device, connect_to(device), journal, seen)) for device in "ab"]
        await asyncio.sleep(1.0)
        pairs[order[0]][1].write(b"x")
        for _ in range(turns):
            await asyncio.sleep(0)
        loop = asyncio.get_running_loop()
        loop._now_ns += apart_ns  # type: ignore[attr-defined]  # time passes while the first is served
        pairs[order[1]][1].write(b"y")
        await asyncio.sleep(1.0)
        journal.command(now_ns(), "end", {})
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return journal.entries, seen

    return run_virtual(main())


def replay(recording: Recording) -> list[str]:
    async def main() -> list[str]:
        seen = list[str]()
        playback = Playback(recording, lambda _: None)
        tasks = [asyncio.create_task(serve(d, playback.line(d).connect, MemoryJournal(), seen)) for d in "ab"]
        await playback.run()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return seen

    return run_recorded(main(), start_ns=0)


@pytest.mark.parametrize("order", ["ab", "ba"])
@pytest.mark.parametrize("turns", range(STEPS + 3))
@pytest.mark.parametrize("apart_ns", [0, 100_000])
def test_two_lines_act_in_the_order_in_which_they_did(tmp_path: Path, order: str, turns: int, apart_ns: int) -> None:
    entries, seen = live(order, turns, apart_ns)
    recorder = Recorder(tmp_path / "turns.mcap", HEADER, entries)
    recorder.close()
    assert len(seen) == 2 * STEPS
    assert replay(read(tmp_path / "turns.mcap")) == seen


def test_without_the_turns_the_order_would_be_another() -> None:
    entries, seen = live("ab", 1, 100_000)
    older = Recording(HEADER, tuple(entry for entry in entries if not isinstance(entry, TurnEntry)))
    assert replay(older) != seen


def test_an_input_that_meets_a_loop_at_rest_has_no_turns() -> None:
    entries, _ = live("ab", STEPS + 60, 0)
    at = next(i for i, entry in enumerate(entries) if isinstance(entry, BytesEntry) and entry.data == b"y")
    assert not isinstance(entries[at - 1], TurnEntry)


def test_what_is_asked_between_two_inputs_tells_them_apart() -> None:
    async def main() -> list[Entry]:
        journal = MemoryJournal()
        journal.bytes_passed("drive", Direction.FROM_BOARD, now_ns(), b"telemetry")
        journal.bytes_passed("drive", Direction.TO_BOARD, now_ns(), b"request")
        await asyncio.sleep(0)
        journal.bytes_passed("drive", Direction.FROM_BOARD, now_ns(), b"reply")
        return journal.entries

    assert not any(isinstance(entry, TurnEntry) for entry in run_virtual(main()))


@pytest.mark.parametrize(
    "note",
    [
        lambda journal: journal.cause(now_ns(), STALL, {}),  # three broken lines, and a mission that is told of both
        lambda journal: journal.command(now_ns(), "clear", {}),  # after a stop that ended an arming
        lambda journal: journal.line_broke("drive", now_ns(), "write: Input/output error"),
        lambda journal: journal.computed(now_ns(), "insert", 0),
    ],
    ids=["stall", "command", "broken line", "computed"],
)
def test_what_answers_nothing_comes_in_its_turn_whatever_was_asked_before(note: Callable[[Journal], None]) -> None:
    async def main() -> list[Entry]:
        journal = MemoryJournal()
        journal.command(now_ns(), "stop", {})
        journal.bytes_passed("drive", Direction.TO_BOARD, now_ns(), b"stop")
        await asyncio.sleep(0)
        note(journal)
        return journal.entries

    *_, turn, _ = run_virtual(main())
    assert isinstance(turn, TurnEntry)
    assert turn.turns == 1


def test_turns_are_written_and_read() -> None:
    entry = TurnEntry(5, 3)
    topic, data = encode(entry)
    assert decode(topic, 5, data) == entry


@pytest.mark.parametrize("turns", [-1, 51, 2**62])
def test_turns_that_no_journal_notes_are_refused(turns: int) -> None:
    with pytest.raises(RecordingError, match="entry 0 of the recording: expected an input 0 to 50 turns"):
        check_recorded(Recording(HEADER, (TurnEntry(1, turns),)))
