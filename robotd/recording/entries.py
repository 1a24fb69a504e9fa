"""What a recording holds: typed entries in the order in which they happened."""

from dataclasses import dataclass, field
from typing import Any

from robotd.hardware.link.tap import Direction

CAUSES_ARE_NOTED = "begun"
"""The first cause in a recording that notes all of them; one without it is older, and its replay has to guess."""


SILENCES_ARE_NOTED = "silences"
"""An argument of that cause, true where each silence that fell is noted as well."""


LINE_BROKE = "line_broke"
"""A cause: a read from the line of ``device`` failed for a ``reason``."""

STALL = "stall"
"""A cause: the loop stood still."""


@dataclass(frozen=True, slots=True)
class RecordingHeader:
    """What a replay must know before the first entry."""

    robotd_version: str
    config_text: str
    """The configuration as TOML, so that a recording is replayed under the settings it was made with."""
    session_seed: int
    """Seed of the session nonces and of everything else the daemon draws at random."""
    wall_offset_ns: int
    """Unix time less monotonic time when the recording began [ns]."""
    started_ns: int
    """When the recording began, monotonic clock of the recording host [ns]."""


@dataclass(frozen=True, slots=True)
class BytesEntry:
    """Bytes that passed a serial line, in the chunk in which they were read or handed over."""

    time_ns: int
    device: str
    direction: Direction
    data: bytes


@dataclass(frozen=True, slots=True)
class LineEntry:
    """A line was opened or lost."""

    time_ns: int
    device: str
    up: bool


@dataclass(frozen=True, slots=True)
class CommandEntry:
    """A client asked for something."""

    time_ns: int
    name: str
    arguments: dict[str, Any]
    encoded: bytes | None = field(default=None, compare=False, repr=False)
    """The message of this entry, once it was made: the making takes long for large ones, so it is done once, and where
    nobody waits for it."""


@dataclass(frozen=True, slots=True)
class ComputedEntry:
    """The ``index``-th piece of array work called ``name`` was handed back, counted from 0."""

    time_ns: int
    name: str
    index: int


@dataclass(frozen=True, slots=True)
class CauseEntry:
    """The daemon took something up that no line, no client and no job brought: a stall of its loop, say.

    Noted where it takes effect, in the order in which it does; a replay lets it take effect at the same place.
    """

    time_ns: int
    name: str
    arguments: dict[str, Any]


@dataclass(frozen=True, slots=True)
class ResultEntry:
    """The daemon came to a result: a sweep, an estimate, a map."""

    time_ns: int
    kind: str
    content: dict[str, Any]
    """Enough of it to show to people; empty where it was encoded already, elsewhere."""
    digest: str
    """Of all of it."""
    encoded: bytes | None = field(default=None, compare=False, repr=False)
    """As of :class:`CommandEntry`."""


@dataclass(frozen=True, slots=True)
class TurnEntry:
    """The next input came before the effects of the one before it were over, this many turns of the loop after it.

    An input without this came when the loop was at rest.
    """

    time_ns: int
    turns: int


Entry = BytesEntry | LineEntry | CommandEntry | ComputedEntry | CauseEntry | ResultEntry | TurnEntry


def is_input(entry: Entry) -> bool:
    """Whether an entry came to the daemon from outside its loop, rather than from its own doing."""
    match entry:
        case BytesEntry():
            return entry.direction is Direction.FROM_BOARD
        case LineEntry():
            return entry.up  # that it is down follows from a failure, or from what the daemon did
        case _:
            return isinstance(entry, CommandEntry | ComputedEntry | CauseEntry)
