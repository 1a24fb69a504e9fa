"""The one timer of silence: it does not count the time for which we ourselves stood still, and a replay can lead it."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial

from robotd.core.attention import attention


class Silence:
    """Calls ``fell_silent`` once, unless it is renewed in time or ended."""

    def __init__(
        self,
        lasts_s: float,
        fell_silent: Callable[[], None],
        *,
        of: str = "",
        begins: bool = True,
        counts_stalls: bool = False,
    ) -> None:
        """Wait for a silence.

        Args:
            lasts_s: how long it must last.
            fell_silent: called then.
            of: whose silence it is, for the journal; one without a name is noted by its owner.
            begins: whether it begins now, or only at the first :meth:`renew`.
            counts_stalls: whether the time counts for which we did not listen: it does where a robot must not go on.
        """
        self._counts_stalls = counts_stalls
        self.of = of
        self.due_s = 0.0
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
        self._attention.give_up(self)

    def fall(self) -> None:
        """Call who waits for it, now."""
        if self.of:
            self._attention.fell(self.of)
        self._fell_silent()

    def _set(self, due_s: float) -> None:
        # What was missed before is no reason to wait longer: only a stall from here on is.
        self._missed_s = self._attention.missed_s
        self.due_s = due_s
        if self.of and self._attention.are_led:
            self._attention.wait_for(self)
        else:
            self._timer = self._loop.call_at(due_s, self._due)

    def _due(self) -> None:
        # The timer may be the first to run after a stall, before anybody noted it.
        self._attention.look()
        missed_s = self._attention.missed_s - self._missed_s
        if missed_s > 0.0 and not self._counts_stalls:
            # What came meanwhile waits to be read. Counted from when it was due, not from now: a replay fires it later.
            self._set(self.due_s + missed_s)
        else:
            self.fall()


@asynccontextmanager
async def within(
    seconds: float, *, of: str, begins: bool = True, counts_stalls: bool = False
) -> AsyncIterator[Silence]:
    """Give the block so long from now or the first renewal on, else TimeoutError; see :class:`Silence`."""
    # Never due by itself: our own timer decides, which knows of stalls and can be led.
    async with asyncio.timeout(None) as limit:
        fell_silent = partial(_end_now, limit)
        silence = Silence(seconds, fell_silent, of=of, begins=begins, counts_stalls=counts_stalls)
        try:
            yield silence
        finally:
            silence.end()


async def idle(seconds: float, *, of: str) -> None:
    """Let some time pass, not counting stalls of ours."""
    over = asyncio.Event()
    silence = Silence(seconds, over.set, of=of)
    try:
        await over.wait()
    finally:
        silence.end()


def _end_now(limit: asyncio.Timeout) -> None:
    # Brought forward to now: asyncio itself then cancels the block and raises, as it would by its own timer.
    limit.reschedule(asyncio.get_running_loop().time())
