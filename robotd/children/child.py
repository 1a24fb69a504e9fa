"""One child, for good: started, watched, killed if it is not well, and started again."""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import NoReturn

from robotd.children.channel import Channel, HungUp
from robotd.children.pings import Patience, watch
from robotd.children.process import Running
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import ChildError

FIRST_WAIT_S = 0.1
LONGEST_WAIT_S = 5.0
"""Between a child's death and the next one's start; twice as long after each that did not last."""
_LASTED_S = 1.0
"""A child that was ready, and lived so long, was well: the next one is started at once."""
_LAST_WORDS_S = 0.05
"""What it said before it went may still be heard."""
_ENDING_S = 1.0
"""One that hung up is about to end, and how it does says more."""

Serve = Callable[[Sequence[Channel]], Awaitable[None]]


@dataclass(frozen=True, slots=True)
class Death:
    """What became of a child."""

    cause: str
    """In words."""
    was_ready: bool
    """Whether it had ever been of use; one that was not will hardly be next time."""
    again_in_s: float
    """When the next one is started."""


class Child:
    """A child that is always there, but for moments."""

    def __init__(
        self,
        name: str,
        version: str,
        *,
        start: Callable[[], Running],
        serve: Serve,
        died: Callable[[Death], None],
        patience: Patience | None = None,
    ) -> None:
        """Prepare; nothing is started yet.

        Args:
            name: as the log calls it.
            version: of this program; a child of another, after an update, is no use.
            start: starts one; ChildError if it cannot.
            serve: talks to it over its lanes, for as long as it lives: from its start on, it is cancelled when it dies.
            died: told of each death, and of each start that failed.
            patience: how long to wait for its signs of life.
        """
        self.is_ready = asyncio.Event()
        """Set while there is one that is of use."""
        self._name = name
        self._version = version
        self._start = start
        self._serve = serve
        self._died = died
        self._patience = patience or Patience()
        self._unwanted: asyncio.Future[str] | None = None
        self._log = logging.getLogger(f"robotd.{name}")

    def kill(self, cause: str) -> None:
        """End the one that lives, and start another: what it computes is not wanted any more."""
        if self._unwanted is not None and not self._unwanted.done():
            self._unwanted.set_result(cause)

    async def run(self) -> NoReturn:
        """Have one until cancelled, which ends it, too."""
        wait_s = 0.0
        while True:
            began_ns = now_ns()
            cause, was_wanted = await self._one_life()
            was_ready = self.is_ready.is_set()
            # Back-off is for what fails by itself: one that we killed, or that served for a while, is followed
            # at once.
            if not was_wanted or (was_ready and now_ns() - began_ns > _LASTED_S * NS_PER_S):
                wait_s = 0.0
            else:
                # Twice nothing is nothing: the first wait of a row comes from the `or`.
                wait_s = min(2.0 * wait_s, LONGEST_WAIT_S) or FIRST_WAIT_S
            # An end that we asked for is no trouble, and nobody should have to read it as one.
            level = logging.WARNING if was_wanted else logging.INFO
            self._log.log(level, "process %s: %s; started again in %.1f s", self._name, cause, wait_s)
            self.is_ready.clear()
            # Told before the wait: what hangs on the child must not count on it for as long.
            self._died(Death(cause, was_ready, wait_s))
            await asyncio.sleep(wait_s)

    async def _one_life(self) -> tuple[str, bool]:
        """Start one, and return why it ended, and whether it was wanted until then."""
        try:
            running = self._start()
        except ChildError as error:
            return str(error), True
        self._unwanted = unwanted = asyncio.get_running_loop().create_future()
        ended = asyncio.create_task(running.ended(), name=f"{self._name}: its end")
        watched = asyncio.create_task(self._watched(running), name=f"{self._name}: watch")
        served = asyncio.create_task(self._served(running), name=f"{self._name}: serve")
        tasks: tuple[asyncio.Future[str], ...] = (unwanted, ended, watched, served)
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            if unwanted in done:
                running.kill()
                return unwanted.result(), False
            # Of several tasks that see the end, the process's own exit says most: a signal or a code, not a
            # closed socket.
            await asyncio.wait((ended,), timeout=_LAST_WORDS_S)
            # In this order: from what happened to what was noticed of it.
            cause = next(task for task in (ended, watched, served) if task.done()).result()
            running.kill()
            return cause, True
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.wait(tasks)
            await self._see_off(running)

    async def _watched(self, running: Running) -> str:
        try:
            await watch(running.life, self._version, self._patience, self.is_ready.set, running.share)
        except HungUp:
            return await _its_end(running)
        except ChildError as error:
            return str(error)

    async def _served(self, running: Running) -> str:
        try:
            await self._serve(running.lanes)
        except HungUp:
            return await _its_end(running)
        except ChildError as error:
            return str(error)
        return "it was hung up on"

    async def _see_off(self, running: Running) -> None:
        """Let it end by itself, or end it: none outlives this."""
        # Hung up on before it is killed: one that is well ends by itself, and its exit code says how.
        running.close()
        try:
            with suppress(TimeoutError):
                async with asyncio.timeout(self._patience.goodbye_s):
                    await running.ended()
        finally:  # also if this process is in a hurry
            running.kill()
        await running.ended()


async def _its_end(running: Running) -> str:
    try:
        async with asyncio.timeout(_ENDING_S):
            return await running.ended()
    except TimeoutError:
        return "it hung up, and did not end"
