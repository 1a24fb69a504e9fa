"""Array work, away from the event loop."""

import asyncio
import os
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol, TypeVar

T = TypeVar("T")


class Compute(Protocol):
    """Somebody who runs a function off the loop and hands back its result."""

    async def run(self, name: str, function: Callable[..., T], *args: object) -> T:
        """Return ``function(*args)``; ``name`` says what it is for in logs and recordings."""


class ThreadCompute:
    """One worker thread: the order of jobs is the order of their results."""

    def __init__(self) -> None:
        self._executor = ThreadPoolExecutor(max_workers=1, thread_name_prefix="compute")

    async def run(self, name: str, function: Callable[..., T], *args: object) -> T:
        """Return ``function(*args)``, computed on the worker thread."""
        return await asyncio.get_running_loop().run_in_executor(self._executor, function, *args)

    def close(self) -> None:
        """Wait for the job under way, drop those behind it, and end the thread."""
        self._executor.shutdown(cancel_futures=True)


def cores() -> int:
    """Return how many processor cores this process may use."""
    return len(os.sched_getaffinity(0))


class NotedCompute:
    """Notes when each job was handed back: a replay hands it back no sooner."""

    def __init__(self, inner: Compute, note: Callable[[str, int], None]) -> None:
        self._inner = inner
        self._note = note
        self._done: Counter[str] = Counter()

    async def run(self, name: str, function: Callable[..., T], *args: object) -> T:
        """Return ``function(*args)`` and note that it is done."""
        result = await self._inner.run(name, function, *args)
        self._note(name, self._done[name])
        self._done[name] += 1
        return result
