"""A daemon of two lines, small enough to be recorded and replayed by a test of playback."""

import asyncio
import functools
import random
import zlib
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any

import pytest

from robotd.core.clock import now_ns, run_virtual
from robotd.core.errors import TransportError
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.memory import MemoryEnd, memory_pair
from robotd.hardware.transport.transport import Connect, Transport
from robotd.hardware.wire.word import Repeat, Word
from robotd.recording.entries import (
    BytesEntry,
    CommandEntry,
    Entry,
    RecordingHeader,
)
from robotd.recording.journal import Journal
from robotd.recording.moments import run_recorded
from robotd.recording.playback import Playback
from robotd.recording.reader import Recording
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


def recorded(test: Callable[[], Coroutine[Any, Any, None]]) -> Callable[[], None]:
    """Run a test on a loop that can be led through recorded moments."""

    @functools.wraps(test)
    def run() -> None:
        run_recorded(test(), start_ns=START_NS)

    del run.__wrapped__  # pytest would see the coroutine function through it
    return run
