"""Where every byte on a serial line can be seen, both ways, with its time."""

import enum
from typing import Protocol


class Direction(enum.StrEnum):
    """Which way bytes went."""

    TO_BOARD = "to_board"
    FROM_BOARD = "from_board"


class Tap(Protocol):
    """Somebody who wants to see the bytes. Must not block and must not raise."""

    def bytes_passed(self, device: str, direction: Direction, time_ns: int, data: bytes) -> None:
        """Note bytes that were read from, or handed to, the line of ``device``."""

    def line_changed(self, device: str, time_ns: int, *, up: bool) -> None:
        """Note that the line of ``device`` was opened or lost."""

    def line_broke(self, device: str, time_ns: int, reason: str) -> None:
        """Note that a read from, or a write to, the line of ``device`` failed, and how; it is given up after that."""
