"""A timer of silence and bytes that are due together: which came first is in the recording, and so it is replayed."""

import asyncio

import pytest

from robotd.core.attention import attention
from robotd.core.clock import NS_PER_S, now_ns, run_virtual
from robotd.core.silence import within
from robotd.hardware.link.tapped import TappedLine
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.transport.transport import Connect, Transport
from robotd.recording.entries import CauseEntry, Entry, RecordingHeader
from robotd.recording.journal import Journal
from robotd.recording.moments import run_recorded
from robotd.recording.playback import Playback
from robotd.recording.reader import Recording
from tests.support.memory_journal import MemoryJournal

HEADER = RecordingHeader("0.1.0", "", 1, 0, 0)
PATIENCE_S = 0.1
OF = "drive answer"


async def wait_for_word(connect: Connect, journal: Journal, said: list[str]) -> None:
    """Say whether bytes came in time."""
    line, heard = TappedLine("drive", await connect(), journal), asyncio.Event()

    async def read() -> None:
        await line.read()
        heard.set()

    reading = asyncio.create_task(read())
    try:
        async with within(PATIENCE_S, of=OF):
            await heard.wait()
        said.append("heard")
    except TimeoutError:
        said.append("silent")
    await reading


def live(bytes_after_s: float, stands_still_s: float) -> tuple[list[Entry], list[str]]:
    """Let bytes come while the loop may stand still, so that it finds them and the timer together."""

    async def main() -> tuple[list[Entry], list[str]]:
        journal, said = MemoryJournal(), list[str]()
        attention().fell = lambda of: journal.cause(now_ns(), "silence", {"of": of})
        near, far = memory_pair("drive")

        async def connect() -> Transport:
            return near

        waiting = asyncio.create_task(wait_for_word(connect, journal, said))
        loop = asyncio.get_running_loop()
        await asyncio.sleep(0)
        loop.call_at(bytes_after_s, far.write, b"word")
        loop._now_ns += round(stands_still_s * NS_PER_S)  # type: ignore[attr-defined]  # a virtual loop's
        await waiting
        journal.command(now_ns(), "end", {})
        return journal.entries, said

    return run_virtual(main())


def replay(entries: list[Entry], *, are_led: bool) -> list[str]:
    async def main() -> list[str]:
        said = list[str]()
        attention().are_led = are_led

        def take_up(entry: CauseEntry) -> None:
            attention().let_fall(entry.arguments["of"])

        playback = Playback(Recording(HEADER, tuple(entries)), lambda _: None, take_up)
        waiting = asyncio.create_task(wait_for_word(playback.line("drive").connect, MemoryJournal(), said))
        await playback.run()
        waiting.cancel()
        await asyncio.gather(waiting, return_exceptions=True)
        return said

    return run_recorded(main(), start_ns=0)


@pytest.mark.parametrize(
    ("bytes_after_s", "stands_still_s", "told"),
    [(0.15, 0.2, "silent"), (0.05, 0.2, "silent"), (0.05, 0.06, "heard"), (0.05, 0.0, "heard"), (0.15, 0.0, "silent")],
)
def test_what_came_first_comes_first_again(bytes_after_s: float, stands_still_s: float, told: str) -> None:
    entries, said = live(bytes_after_s, stands_still_s)
    assert said == [told]
    assert replay(entries, are_led=True) == said


def test_left_to_its_timers_a_replay_would_hear_what_was_not_heard() -> None:
    entries, said = live(0.15, 0.2)
    noted = [entry for entry in entries if not (isinstance(entry, CauseEntry) and entry.name == "silence")]
    assert len(noted) == len(entries) - 1
    assert replay(noted, are_led=False) != said
