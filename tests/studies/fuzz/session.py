"""Short sessions of a simulated robot, as the messages of their recordings.

Short, for a replay takes as long as what was recorded is long: boards report seldom, and a session does one thing.
"""

import asyncio
import random
import tempfile
from collections.abc import Callable, Coroutine
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from robotd.config import Config, effective_text
from robotd.contract.events import Event, MissionProgress
from robotd.contract.missions import DriveStraight, Legs, Localize, MapStart, Mission
from robotd.contract.requests import Arm, Clear, MapLoad, MapSave, RecordStop, Stop
from robotd.core.clock import now_ns, run_virtual
from robotd.hardware.devices.dialects import MOTORLESS
from robotd.mission.safety.hold import Stall
from robotd.recording.encoding import HEADER_TOPIC, encode, encode_header
from robotd.recording.reader import Recording, read
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.faults.fault_words import FAULTS
from tests.support.bench import Bench, bench

_READINGS = 4
_REPORTS = {"telemetry_ms": 150}


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
    settings: tuple[str, ...]
    """All of the configuration, ``section.key = value`` each; the header has those alone that are no defaults."""
    directory: Path


async def _maps(it: Bench) -> None:
    await _done(it, MapStart.of("first", (), it.robot.start, Legs.STRAIGHT))
    await it.daemon.control.perform(MapSave())


async def _finds_itself(it: Bench) -> None:
    await asyncio.sleep(0.2)  # the base has said by now where it is
    await it.daemon.control.perform(MapLoad.of("first", None, it.robot.start))
    await _done(it, Localize())


async def _drives(it: Bench) -> None:
    await _done(it, DriveStraight(0.02))


async def _is_interrupted(it: Bench) -> None:
    ask: Callable[[Any], Coroutine[Any, Any, object]] = it.daemon.control.perform
    await ask(Arm())
    it.daemon.causes.stalled(Stall(now_ns(), 0.4, was_stopped=False, log="the log"))
    await ask(Stop("enough"))
    it.cables["pantilt"].set_fault(FAULTS["unplug"](random.Random(1)))
    await asyncio.sleep(0.3)
    await ask(Clear())


LIVES: dict[str, tuple[Dialects, Callable[[Bench], Coroutine[Any, Any, None]]]] = {
    "maps": (Dialects(), _maps),
    "finds-itself": (Dialects("rflex", MOTORLESS, "scip"), _finds_itself),
    "drives": (Dialects("rwi-ascii", "dynamixel", "lw20"), _drives),
    "is-interrupted": (Dialects("rflex", "ptu", "dimetix"), _is_interrupted),
}
"""What a session does, and by what devices: vendors', for boards of our own begin with a hundred messages."""


def session(life: str) -> Session:
    """Return the session of a name of :data:`LIVES`."""
    return _sessions()[life]


@cache
def _sessions() -> dict[str, Session]:
    with tempfile.TemporaryDirectory(prefix="fuzz-session-") as directory:
        return {name: _lived(Path(directory), *life) for name, life in LIVES.items()}


def _lived(directory: Path, dialects: Dialects, live: Callable[[Bench], Coroutine[Any, Any, None]]) -> Session:
    """Live through one on the virtual clock."""
    run_virtual(_recorded(directory, dialects, live))
    (file,) = (directory / "recordings").glob("*.mcap")
    recording = read(file)
    file.unlink()
    settings = _settings(recording.header.config_text)
    entries = ((entry.time_ns, *encode(entry)) for entry in recording.entries)
    return Session(
        (_short_header(recording, settings), *(Message(topic, at, data) for at, topic, data in entries)),
        settings,
        directory,
    )


def _short_header(recording: Recording, settings: tuple[str, ...]) -> Message:
    """Return a header without the defaults: a quarter of a short replay would be to read them."""
    usual = set(_settings(effective_text(Config())))
    text = "\n".join(one for one in settings if one not in usual)
    return Message(
        HEADER_TOPIC, recording.header.started_ns, encode_header(replace(recording.header, config_text=text))
    )


def _settings(text: str) -> tuple[str, ...]:
    section, found = "", []
    for line in text.splitlines():
        if line.startswith("["):
            section = line.strip("[]")
        elif " = " in line:
            found.append(f"{section}.{line}" if section else line)
    return tuple(found)


async def _recorded(directory: Path, dialects: Dialects, live: Callable[[Bench], Coroutine[Any, Any, None]]) -> None:
    reports = _REPORTS if dialects == Dialects() else {}
    async with bench(directory, dialects, readings=_READINGS, reports=reports) as it:
        await live(it)
        await it.daemon.control.perform(RecordStop())


async def _done(it: Bench, mission: Mission) -> None:
    def is_over(event: Event) -> bool:
        return isinstance(event, MissionProgress) and event.is_last

    await it.daemon.control.perform(Arm())
    it.start(mission)
    await it.until(is_over)
