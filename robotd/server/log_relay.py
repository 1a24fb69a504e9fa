"""The daemon's log, as events."""

import asyncio
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from robotd.contract.topics import LogEntry
from robotd.core.clock import now_ns
from robotd.core.text import printable_lines

_LONGEST_MESSAGE = 2000


class _Relay(logging.Handler):
    """Hands records, from whatever thread, to the loop."""

    def __init__(self, deliver: Callable[[LogEntry], None]) -> None:
        super().__init__(logging.INFO)
        self._loop = asyncio.get_running_loop()
        self._deliver = deliver

    def emit(self, record: logging.LogRecord) -> None:
        try:
            line = (record.levelname, record.name, _shown(record.getMessage()))
            self._loop.call_soon_threadsafe(self._on_loop, *line)
        except Exception:  # a bad record, or a loop that has ended: the log's own way to take it
            self.handleError(record)

    def _on_loop(self, level: str, logger: str, message: str) -> None:
        self._deliver(LogEntry(now_ns(), level, logger, message))


def _shown(message: str) -> str:
    """Return a message as printable lines, within bounds."""
    return printable_lines(message[:_LONGEST_MESSAGE])[:_LONGEST_MESSAGE]


@contextmanager
def relay_log(deliver: Callable[[LogEntry], None]) -> Iterator[None]:
    """Deliver what robotd logs from ``INFO`` up, on the running loop, for the length of a ``with`` block."""
    relay = _Relay(deliver)
    logger = logging.getLogger("robotd")
    logger.addHandler(relay)
    try:
        yield
    finally:
        logger.removeHandler(relay)
