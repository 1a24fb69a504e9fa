"""Array work, away from the event loop."""

import asyncio
import contextlib
import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol, TypeVar

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
        self._executor = ThreadPoolExecutor(max_workers=1, thread_name_prefix="compute", initializer=_give_way)

    async def run(self, name: str, function: Callable[..., T], *args: object) -> T:
        """Return ``function(*args)``, computed on the worker thread."""
        return await asyncio.get_running_loop().run_in_executor(self._executor, function, *args)

    def close(self) -> None:
        """Wait for the job under way, drop those behind it, and end the thread."""
        self._executor.shutdown(cancel_futures=True)

    def abandon(self) -> None:
        """Wait for nothing: the job under way has no more to say, and with it the thread ends."""
        self._executor.shutdown(wait=False, cancel_futures=True)


def _give_way() -> None:
    """Let this thread, and those that it starts, have no precedence; on Linux niceness is a thread's own."""
    thread = threading.get_native_id()
    # Only precedence is given up: a daemon that was started nicer than others stays so.
    if os.getpriority(os.PRIO_PROCESS, thread) < 0:
        with contextlib.suppress(OSError):  # where that is forbidden it stays as it is
            os.setpriority(os.PRIO_PROCESS, thread, 0)
