"""The one timer of silence: it does not count the time for which we ourselves stood still."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

from robotd.core.attention import attention


class Silence:
    """Calls ``fell_silent`` once, unless it is renewed in time or ended."""

    def __init__(self, lasts_s: float, fell_silent: Callable[[], None], *, begins: bool = True) -> None:
        """Begin to wait, or only at the first :meth:`renew`."""
        self._lasts_s = lasts_s
        self._fell_silent = fell_silent
        self._attention = attention()
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.TimerHandle | None = None
        if begins:
            self._set(self._loop.time() + lasts_s)

    def renew(self) -> None:
        """Start the time again."""
        self.end()
        self._set(self._loop.time() + self._lasts_s)

    def end(self) -> None:
        """Call nobody any more."""
        if self._timer is not None:
            self._timer.cancel()

    def _set(self, due_s: float) -> None:
        self._missed_s = self._attention.missed_s
        self._due_s = due_s
        self._timer = self._loop.call_at(due_s, self._due)

    def _due(self) -> None:
        self._attention.look()
        missed_s = self._attention.missed_s - self._missed_s
        if missed_s > 0.0:
            # What came meanwhile waits to be read. Counted from when it was due, not from now: a replay fires it later.
            self._set(self._due_s + missed_s)
        else:
            self._fell_silent()


@asynccontextmanager
async def within(seconds: float, *, begins: bool = True) -> AsyncIterator[Silence]:
    """Give the block so long, not counting stalls of ours, from now or the first renewal on; else TimeoutError."""
    async with asyncio.timeout(None) as limit:
        loop = asyncio.get_running_loop()
        silence = Silence(seconds, lambda: limit.reschedule(loop.time()), begins=begins)
        try:
            yield silence
        finally:
            silence.end()
