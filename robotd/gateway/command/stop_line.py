"""STOP: a line of its own to the daemon, past every queue, limit and lock, said again until it is answered.

A stop is carried out each time it comes, so repeating it does no harm; it is the one thing that is repeated.
"""

import asyncio
import contextlib
from collections import deque

from robotd.contract.answers import Done
from robotd.contract.requests import Stop
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.counted import Distribution
from robotd.core.errors import RobotdError, ServerError
from robotd.gateway.command.asker import Asks

AGAIN_S = 0.1
GIVEN_UP_S = 3.0
_AT_ONCE = 32
"""Stops under way at a time, each repeated; who presses meanwhile shares the answer of the last."""


class StopLine:
    """Stops the robot and tells how long that took."""

    def __init__(self, asker: Asks) -> None:
        """Stop over an ``asker`` that nobody else uses."""
        self._asker = asker
        self._under_way: deque[asyncio.Task[float]] = deque()
        self.seconds = Distribution()
        """How long those took that were confirmed."""
        self.unconfirmed = 0

    @property
    def confirmed(self) -> int:
        """How many the daemon confirmed."""
        return sum(self.seconds.counts)

    async def stop(self, reason: str) -> float:
        """Stop the robot; return after how many seconds the daemon said that it had.

        Raises:
            ServerError: it did not say so in time.
        """
        if len(self._under_way) < _AT_ONCE:
            task = asyncio.create_task(self._until_confirmed(reason), name="stop")
            self._under_way.append(task)
            task.add_done_callback(self._ended)
        # Shielded: a browser that goes away while it stops the robot takes back nothing.
        return await asyncio.shield(self._under_way[-1])

    async def end(self) -> None:
        """Wait for the stops that are under way: they go on though who pressed is gone."""
        await asyncio.gather(*self._under_way, return_exceptions=True)

    async def _until_confirmed(self, reason: str) -> float:
        begun_ns = now_ns()
        request = Stop.because(reason)
        waiting: set[asyncio.Task[Done]] = set()
        try:
            while (took_s := (now_ns() - begun_ns) / NS_PER_S) < GIVEN_UP_S:
                # The ones before go on: whichever is answered first will do.
                waiting.add(asyncio.create_task(self._asker.ask(request, GIVEN_UP_S - took_s)))
                done, waiting = await asyncio.wait(waiting, timeout=AGAIN_S, return_when=asyncio.FIRST_COMPLETED)
                if any(task.exception() is None for task in done):
                    took_s = (now_ns() - begun_ns) / NS_PER_S
                    self.seconds.take(took_s)
                    return took_s
                if done:  # nobody is there, or it was refused: not at once again, or this loop would spin
                    await asyncio.sleep(AGAIN_S / 4)
        finally:
            for task in waiting:
                task.cancel()
            await asyncio.gather(*waiting, return_exceptions=True)
        self.unconfirmed += 1
        raise ServerError("not_confirmed", "the daemon did not confirm the stop: use the emergency stop on the robot")

    def _ended(self, task: "asyncio.Task[float]") -> None:
        self._under_way.remove(task)
        with contextlib.suppress(asyncio.CancelledError, RobotdError):
            task.result()
