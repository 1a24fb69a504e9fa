"""The daemon's log, as events."""

import asyncio
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from robotd.contract.topics import LogEntry
from robotd.core.clock import now_ns
from robotd.core.text import printable_lines

_LONGEST_MESSAGE = 2000

log = logging.getLogger(__name__)


class _Relay(logging.Handler):
    """Hands records, from whatever thread, to the loop.

    What fails is said once, and not to clients: a line about lines that cannot be relayed would be the next of them.
    """

    def __init__(self, deliver: Callable[[LogEntry], None]) -> None:
        super().__init__(logging.INFO)
        self._loop = asyncio.get_running_loop()
        self._deliver = deliver
        self._is_failing = False

    def emit(self, record: logging.LogRecord) -> None:
        # Its own complaints are not relayed: each would be the next line that fails.
        if record.name == __name__:
            return
        try:
            line = (record.levelname, record.name, _shown(record.getMessage()))
            # Records come from every thread; events are the loop's alone.
            self._loop.call_soon_threadsafe(self._on_loop, *line)
        except Exception as error:  # a bad record, or a loop that has ended
            self._complain(record.name, error)

    def _on_loop(self, level: str, logger: str, message: str) -> None:
        try:
            self._deliver(LogEntry(now_ns(), level, logger, message))
        except Exception as error:  # a callback of the loop that fails would stop the robot
            self._complain(logger, error)
        else:
            self._is_failing = False

    def _complain(self, logger: str, error: Exception) -> None:
        if not self._is_failing:
            self._is_failing = True
            log.error("a line of %s did not reach the clients: %r", logger, error)


def _shown(message: str) -> str:
    """Return a message as printable lines, within bounds."""
    # Cut twice: before, so that no time goes into what is cut anyway; after, since escapes make it longer.
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
