"""Replay in process: the whole daemon, on a recording instead of on serial lines, on the virtual clock."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robotd import __version__
from robotd.app.as_recorded import recorded_config
from robotd.app.compose import Daemon, compose, head_settings
from robotd.config import Config
from robotd.contract.events import Event
from robotd.core.attention import attention
from robotd.core.broadcast import Broadcast
from robotd.core.clock import NS_PER_S
from robotd.core.errors import RecordingError, RobotdError
from robotd.core.text import printable
from robotd.hardware.devices.catalogue import request_words
from robotd.head.cores import cores
from robotd.head.desk import Desk
from robotd.head.near import HeadAtHand
from robotd.mission.noted import check_noted
from robotd.mission.safety.causes import check_cause
from robotd.recording.comparison import Difference, compare, results_digest
from robotd.recording.entries import (
    LINE_BROKE,
    BytesEntry,
    CauseEntry,
    CommandEntry,
    Entry,
    LineEntry,
    RecordingHeader,
    ResultEntry,
    TurnEntry,
)
from robotd.recording.journal import TURNS_MAX
from robotd.recording.moments import pass_to, run_recorded
from robotd.recording.playback import Playback
from robotd.recording.preroll import PrerollJournal
from robotd.recording.reader import Recording, read

_NO_LIMIT = 2**62
"""Of the replay's own journal: the comparison needs all of it, and a recording has an end."""
_HEARD_AT_ONCE = 4096
"""Events that one turn of the loop may bring."""
_VERSION_MAX = 40
"""Letters: it is what a file says of itself."""
DEVICES = ("drive", "pantilt", "rangefinder")


@dataclass(frozen=True, slots=True)
class ReplayReport:
    """What came of a replay."""

    digest: str
    """Over all results, in order: equal for two replays exactly if all results are."""
    recorded_digest: str
    """The same over the results in the recording."""
    results: int
    differences: tuple[Difference, ...]
    complete: bool
    """Whether the recording was ended properly, rather than cut off."""
    duration_s: float
    """How long the recorded robot lived."""
    recorded_by: str
    """Version of the daemon that made the recording, as it says itself."""
    replayed_by: str = __version__


def replay_recording(path: Path) -> ReplayReport:
    """Give the daemon the same bytes and commands at the same times, and compare what comes of it.

    Raises:
        RecordingError: the file is no recording, nothing of it can be read, or it holds what no daemon wrote.
        ConfigError: the recording's configuration is not one of this version.
    """
    recording, config = _repeatable(path)
    replayed = _played(recording, config)
    return ReplayReport(
        digest=results_digest(replayed),
        recorded_digest=results_digest(recording.entries),
        results=sum(isinstance(entry, ResultEntry) for entry in replayed),
        differences=compare(recording, replayed, request_words(config.devices)),
        complete=recording.complete,
        duration_s=(recording.end_ns - recording.header.started_ns) / NS_PER_S,
        recorded_by=printable(recording.header.robotd_version, _VERSION_MAX),
    )


def replay_events(path: Path, hear: Callable[[Event], None]) -> RecordingHeader:
    """Have ``hear`` called with everything that a recorded daemon told its clients, in order; a map changes in steps.

    Raises:
        RecordingError: the file is no recording, nothing of it can be read, or it holds what no daemon wrote.
        ConfigError: the recording's configuration is not one of this version.
    """
    recording, config = _repeatable(path)
    _played(recording, config, hear)
    return recording.header


def _repeatable(path: Path) -> tuple[Recording, Config]:
    recording = read(path)
    check_recorded(recording)
    return recording, recorded_config(recording.header.config_text)


def _played(recording: Recording, config: Config, hear: Callable[[Event], None] | None = None) -> tuple[Entry, ...]:
    """Return what a daemon notes when it is given once more what came to the recorded one."""
    return run_recorded(_play(recording, config, hear), start_ns=recording.header.started_ns)


def check_recorded(recording: Recording) -> None:
    """Refuse a recording with an entry that cannot be repeated, whatever its checksums say.

    Raises:
        RecordingError: says which entry, and what was expected.
    """
    for number, entry in enumerate(recording.entries):
        try:
            if isinstance(entry, CommandEntry):
                check_noted(entry.name, entry.arguments)
            elif isinstance(entry, CauseEntry):
                check_cause(entry.name, entry.arguments)
                if entry.name == LINE_BROKE:
                    _check_broken(entry.arguments)
            elif isinstance(entry, BytesEntry | LineEntry):
                _check_device(entry.device)
            elif isinstance(entry, TurnEntry):
                _check_turns(entry.turns)
        except RecordingError as error:
            raise RecordingError(f"entry {number} of the recording: {error}") from error


def _check_broken(arguments: dict[str, Any]) -> None:
    device, reason = arguments.get("device"), arguments.get("reason")
    if not isinstance(device, str) or not isinstance(reason, str):
        raise RecordingError(f"cause {LINE_BROKE!r}: expected a device and a reason, got {str(arguments)[:80]}")
    _check_device(device)


def _check_turns(turns: int) -> None:
    if not 0 <= turns <= TURNS_MAX:
        raise RecordingError(f"expected an input 0 to {TURNS_MAX} turns after another, got {turns}")


def _check_device(device: str) -> None:
    if device not in DEVICES:
        raise RecordingError(f"expected one of the devices {', '.join(DEVICES)}, got {device[:40]!r}")


async def _play(recording: Recording, config: Config, hear: Callable[[Event], None] | None) -> tuple[Entry, ...]:
    """Let the daemon live through the recording and return what its journal noted until it ended."""
    # With the header of the recording: the seed in it is what nonces are drawn from.
    journal = PrerollJournal(recording.header, _NO_LIMIT)
    requests: set[asyncio.Task[None]] = set()

    def carry_out(entry: CommandEntry) -> None:
        task = asyncio.create_task(_repeat(daemon, entry), name=f"repeat {entry.name}")
        requests.add(task)
        task.add_done_callback(requests.discard)

    def take_up(entry: CauseEntry) -> None:
        daemon.causes.repeat(entry.name, entry.arguments)

    playback = Playback(recording, carry_out, take_up)
    # Before the daemon is made: a silence asks when it begins whether it is led.
    attention().are_led = recording.notes_silences
    connects = {device: playback.line(device).connect for device in DEVICES}
    head = HeadAtHand(Desk(head_settings(config), threads=cores()), playback.compute)
    # The store is asked by nobody: what clients only look at was not noted.
    daemon = compose(config, connects, head, playback.compute, journal, leases_end_by_causes=recording.notes_causes)
    async with asyncio.TaskGroup() as group:
        parts = [group.create_task(part, name=name) for name, part in daemon.parts().items()]
        # A listener more changes no turn of the others: each has a queue of its own.
        if hear is not None:
            parts.append(group.create_task(_hear(daemon.control.events, hear), name="hear"))
        await playback.run()
        replayed = tuple(journal.remembered)  # before it is stopped, which the recorded one may not have been
        for task in (*parts, *requests):
            task.cancel()
        # Else the mission that the recording was cut in would keep the group from ending.
        await daemon.supervisor.stop("the recording ended")
    return replayed


async def _hear(events: Broadcast[Event], hear: Callable[[Event], None]) -> None:
    with events.subscribe(_HEARD_AT_ONCE) as subscription:
        async for event in subscription:
            hear(event)


async def _repeat(daemon: Daemon, entry: CommandEntry) -> None:
    pass_to(entry.time_ns)
    try:
        await daemon.control.repeat(entry.name, entry.arguments)
    except RobotdError:
        return  # it was refused, as it was when it was recorded; what differs shows in the comparison
