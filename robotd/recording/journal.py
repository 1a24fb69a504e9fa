"""Where the daemon notes what happens: on the lines, from its clients, in its own computing."""

from abc import ABC, abstractmethod
from typing import Any

from robotd.hardware.link.tap import Direction
from robotd.recording.entries import (
    LINE_BROKE,
    BytesEntry,
    CauseEntry,
    CommandEntry,
    ComputedEntry,
    Entry,
    LineEntry,
    ResultEntry,
)


class Journal(ABC):
    """Takes notes, and is a :class:`robotd.hardware.link.tap.Tap`. All times are monotonic [ns]."""

    @abstractmethod
    def note(self, entry: Entry) -> None:
        """Take an entry. Does not block."""

    def bytes_passed(self, device: str, direction: Direction, time_ns: int, data: bytes) -> None:
        """Note bytes that were read from, or handed to, the line of ``device``."""
        self.note(BytesEntry(time_ns, device, direction, bytes(data)))

    def line_changed(self, device: str, time_ns: int, *, up: bool) -> None:
        """Note that the line of ``device`` was opened or lost."""
        self.note(LineEntry(time_ns, device, up))

    def line_broke(self, device: str, time_ns: int, reason: str) -> None:
        """Note how the line of ``device`` failed: what is told of it must be told again."""
        self.cause(time_ns, LINE_BROKE, {"device": device, "reason": reason})

    def command(self, time_ns: int, name: str, arguments: dict[str, Any]) -> None:
        """Note what a client asked for; ``arguments`` must fit into JSON."""
        self.note(CommandEntry(time_ns, name, arguments))

    def computed(self, time_ns: int, name: str, index: int) -> None:
        """Note that the ``index``-th job called ``name`` was handed back to the loop."""
        self.note(ComputedEntry(time_ns, name, index))

    def cause(self, time_ns: int, name: str, arguments: dict[str, Any]) -> None:
        """Note what is taken up now although no line, no client and no job brought it; ``arguments`` as in JSON."""
        self.note(CauseEntry(time_ns, name, arguments))

    def result(self, time_ns: int, kind: str, content: dict[str, Any], digest: str) -> None:
        """Note a result; ``content`` must fit into JSON, ``digest`` stands for the whole of it."""
        self.note(ResultEntry(time_ns, kind, content, digest))


class MemoryJournal(Journal):
    """Keeps the entries in a list."""

    def __init__(self) -> None:
        self.entries: list[Entry] = []

    def note(self, entry: Entry) -> None:
        """Keep an entry."""
        self.entries.append(entry)
