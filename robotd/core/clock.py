"""The one place that reads time.

Everything in the daemon asks :func:`now_ns` and sleeps through asyncio, so a program that runs on
:class:`VirtualClockLoop` runs on virtual time, whole and unmodified: when nothing is ready, the clock
jumps to the next timer. Tests and replay use it; they never wait, and they are repeatable.
"""

import asyncio
import selectors
import time
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

NS_PER_S = 1_000_000_000
_STUCK_AFTER_S = 10.0
"""Real time for a descriptor to become ready when no timer is set; after it, a program that hangs is an error."""

T = TypeVar("T")


def now_ns() -> int:
    """Return the monotonic time of the running loop [ns], real or virtual."""
    # By the loop and not by the system: the one call that a virtual clock has to answer.
    return round(asyncio.get_running_loop().time() * NS_PER_S)


def wall_offset_ns() -> int:
    """Return what to add to a monotonic time to get Unix time [ns], as of now."""
    return time.time_ns() - time.monotonic_ns()


class TurnCountingLoop(asyncio.SelectorEventLoop):
    """An event loop that counts its turns, so that a recording can say what happened while nothing was at rest."""

    def __init__(self, selector: "CountingSelector | None" = None) -> None:
        self._counting = selector or CountingSelector()
        super().__init__(self._counting)
        # Asked of the loop's own queue: only it knows whether a turn has anything left to do.
        self._counting.follow(lambda: not self._ready)  # type: ignore[attr-defined]  # asyncio's own queue

    @property
    def turn(self) -> int:
        """Number of the turn under way."""
        return self._counting.turn

    @property
    def rested_at(self) -> int:
        """Number of the last turn before which there was nothing left to do."""
        return self._counting.rested_at


class CountingSelector(selectors.DefaultSelector):
    """A selector that counts: a loop asks it once each turn."""

    def __init__(self) -> None:
        super().__init__()
        self.turn = 0
        self.rested_at = 0
        self._is_at_rest: Callable[[], bool] = lambda: True

    def follow(self, is_at_rest: Callable[[], bool]) -> None:
        """Ask this whether the loop has nothing to do; a timer that is due counts as nothing, as in a replay."""
        self._is_at_rest = is_at_rest

    def _count(self) -> None:
        self.turn += 1
        if self._is_at_rest():
            self.rested_at = self.turn

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        """Count the turn, and wait for descriptors as any selector does."""
        self._count()
        return super().select(timeout)


class VirtualClockLoop(TurnCountingLoop):
    """An event loop whose clock jumps to the next timer as soon as nothing is ready.

    Executor work is done at once, on this thread: it takes no virtual time and keeps its order.
    """

    def __init__(self, start_ns: int = 0) -> None:
        self._now_ns = start_ns
        super().__init__(_JumpingSelector(self._jump))

    def time(self) -> float:
        """Return the virtual time [s]."""
        return self._now_ns / NS_PER_S

    def _jump(self, by_s: float) -> None:
        # At least one: a wait that rounds to nothing would be asked for again without end.
        self._now_ns += max(1, round(by_s * NS_PER_S))

    def run_in_executor(self, executor: Any, func: Callable[..., T], *args: Any) -> asyncio.Future[T]:  # type: ignore[override]  # typeshed has the loop's TypeVarTuple here
        """Run ``func`` now and return its finished future."""
        future: asyncio.Future[T] = self.create_future()
        try:
            future.set_result(func(*args))
        except Exception as error:  # handed to the one who awaits
            future.set_exception(error)
        return future


class _JumpingSelector(CountingSelector):
    """A selector that turns waiting into a jump of the clock."""

    def __init__(self, jump: Callable[[float], None]) -> None:
        super().__init__()
        self._jump = jump

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        self._count()
        if timeout is None:
            # Real descriptors, as those of child processes, are waited for in real time: nothing could make
            # them ready sooner.
            ready = selectors.DefaultSelector.select(self, _STUCK_AFTER_S)
            if not ready:
                raise RuntimeError("virtual time is stuck: no timer is set and no descriptor is ready")
            return ready
        ready = selectors.DefaultSelector.select(self, 0)
        if not ready and timeout > 0:
            self._jump(timeout)
        return ready


def run_counting(main: Coroutine[Any, Any, T]) -> T:
    """Run a coroutine to its end in real time, on a loop that counts its turns."""
    with asyncio.Runner(loop_factory=TurnCountingLoop) as runner:
        return runner.run(main)


def run_virtual(main: Coroutine[Any, Any, T], *, start_ns: int = 0) -> T:
    """Run a coroutine to its end in virtual time and return its result."""
    with asyncio.Runner(loop_factory=lambda: VirtualClockLoop(start_ns)) as runner:
        return runner.run(main)
