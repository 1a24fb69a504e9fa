"""Array work, away from the event loop."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol, TypeVar

from robotd.core.precedence import give_way

T = TypeVar("T")


class Compute(Protocol):
    """Somebody who runs a function off the loop and hands back its result."""

    async def run(self, name: str, function: Callable[..., T], *args: object) -> T:
        """Return ``function(*args)``; ``name`` says what it is for in logs and recordings."""


class ThreadCompute:
    """One worker thread: the order of jobs is the order of their results.

    It gives way to the loop: a daemon that was given precedence, so that nothing starves a stop, computes without it.
    """

    def __init__(self) -> None:
        # One worker: jobs that overtake each other would come back in another order in a replay.
        self._executor = ThreadPoolExecutor(max_workers=1, thread_name_prefix="compute", initializer=give_way)

    async def run(self, name: str, function: Callable[..., T], *args: object) -> T:
        """Return ``function(*args)``, computed on the worker thread."""
        return await asyncio.get_running_loop().run_in_executor(self._executor, function, *args)

    def close(self) -> None:
        """Wait for the job under way, drop those behind it, and end the thread."""
        self._executor.shutdown(cancel_futures=True)

    def abandon(self) -> None:
        """Wait for nothing: the job under way has no more to say, and with it the thread ends."""
        self._executor.shutdown(wait=False, cancel_futures=True)
