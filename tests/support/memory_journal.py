"""A journal that keeps what it was told."""

from robotd.recording.entries import Entry
from robotd.recording.journal import Journal


class MemoryJournal(Journal):
    """Keeps the entries in a list."""

    def __init__(self) -> None:
        self.entries: list[Entry] = []

    def note(self, entry: Entry) -> None:
        """Keep an entry."""
        self.entries.append(entry)
