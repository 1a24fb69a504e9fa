"""A short session of a simulated robot, as the messages of its recording."""

import asyncio
import random
import tempfile
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from robotd.contract.events import Event, MissionProgress
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart, Mission
from robotd.contract.requests import Arm, Clear, MapLoad, MapSave, RecordStop, Stop
from robotd.core.clock import now_ns, run_virtual
from robotd.mission.safety.hold import Stall
from robotd.recording.encoding import HEADER_TOPIC, encode, encode_header
from robotd.recording.reader import read
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.faults.catalogue import FAULTS
from tests.support.bench import Bench, bench

_READINGS = 4
"""A short recording can be replayed often."""


@dataclass(frozen=True, slots=True)
class Message:
    """One message of a recording; ``topic`` is its channel."""

    topic: str
    time_ns: int
    data: bytes


@dataclass(frozen=True, slots=True)
class Session:
    """What was recorded, the header first, and where: the directory is gone, and a replay makes none."""

    messages: tuple[Message, ...]
    directory: Path


@cache
def session() -> Session:
    """Live through one on the virtual clock: maps, a way, a place, a stall, and a line that broke."""
    with tempfile.TemporaryDirectory(prefix="fuzz-session-") as directory:
        run_virtual(_live(Path(directory)))
        (file,) = (Path(directory) / "recordings").glob("*.mcap")
        recording = read(file)
    header = Message(HEADER_TOPIC, recording.header.started_ns, encode_header(recording.header))
    entries = ((entry.time_ns, *encode(entry)) for entry in recording.entries)
    return Session((header, *(Message(topic, at, data) for at, topic, data in entries)), Path(directory))


async def _live(directory: Path) -> None:
    async with bench(directory, Dialects(), readings=_READINGS) as it:
        ask: Callable[[Any], Coroutine[Any, Any, object]] = it.daemon.control.perform
        await _done(it, MapStart.of("first", (), it.robot.start, Legs.STRAIGHT))
        await _done(it, DriveTo(it.robot.start.x_m + 0.1, it.robot.start.y_m, Legs.STRAIGHT))
        await ask(MapSave())
        await ask(MapLoad.of("first", None, it.robot.start))
        await _done(it, Localize())
        await ask(Arm())
        it.daemon.causes.stalled(Stall(now_ns(), 0.4, was_stopped=False, log="the log"))
        await ask(Stop("enough"))
        it.cables["pantilt"].set_fault(FAULTS["unplug"](random.Random(1)))
        await asyncio.sleep(0.3)
        await ask(Clear())
        await ask(RecordStop())


async def _done(it: Bench, mission: Mission) -> None:
    def is_over(event: Event) -> bool:
        return isinstance(event, MissionProgress) and event.is_last

    await it.daemon.control.perform(Arm())
    it.start(mission)
    await it.until(is_over)
