"""How much of the journal may wait in memory: this many bytes for each source, so that none takes the place of another.

A client that asks ten thousand times, or a map that hardly packs, must not cost the recording of the lines' bytes. So
each source has its own budget. One entry alone is always taken, however large: it is in memory already, and a replay
needs it.
"""

import enum
from collections import Counter

from robotd.recording.entries import BytesEntry, CauseEntry, CommandEntry, Entry, LineEntry, TurnEntry


class Source(enum.StrEnum):
    """Where entries come from."""

    LINES = "the lines"
    REQUESTS = "requests of clients"
    MAPS = "maps that were taken into use"
    RESULTS = "results"


def source_of(entry: Entry) -> Source:
    """Return where an entry comes from."""
    match entry:
        case BytesEntry() | LineEntry() | CauseEntry() | TurnEntry():
            return Source.LINES
        case CommandEntry():
            return Source.MAPS if "grid" in entry.arguments else Source.REQUESTS
        case _:
            return Source.RESULTS


class Budgets:
    """The same bound for each source."""

    def __init__(self, limit_bytes: int) -> None:
        self._limit_bytes = limit_bytes
        self._used: Counter[Source] = Counter()

    @property
    def used_bytes(self) -> int:
        """What all sources have used together."""
        return self._used.total()

    def use(self, source: Source, size_bytes: int) -> bool:
        """Take memory for an entry and return whether its source stayed within bounds."""
        is_alone = self._used[source] == 0
        self._used[source] += size_bytes
        return is_alone or self._used[source] <= self._limit_bytes

    def free(self) -> None:
        """Give back what all sources have used: the entries are gone."""
        self._used.clear()
