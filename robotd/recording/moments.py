"""Virtual time that passes from one recorded moment to the next.

A living loop is sometimes late: when the machine is busy, bytes and timers that fell due one after the other are
found together, and the bytes are served first. A replay is never late, so its timers would fire between two
recorded moments although the living ones did not, and give up requests that were answered in time. But whatever
a timer did that mattered was written to a line or noted as a result, and so is a recorded moment itself.
Hence nothing but recorded moments exists here: what falls due between two of them happens at the later one, once
everything that was recorded there has had its effect.
"""

import asyncio
import heapq
import math
from collections.abc import Callable, Coroutine
from contextvars import Context
from itertools import count
from typing import Any, TypeVar

from robotd.core.clock import NS_PER_S, VirtualClockLoop

T = TypeVar("T")


class RecordedTimeLoop(VirtualClockLoop):
    """A virtual loop that can be led through recorded moments; it keeps its own timers, to fire them last."""

    def __init__(self, start_ns: int) -> None:
        super().__init__(start_ns)
        self._next_ns: Callable[[], int | None] = _never
        self._play: Callable[[], None] = _nothing
        self._timers: list[tuple[float, int, asyncio.TimerHandle]] = []
        self._numbers = count()
        super().call_at(math.inf, _nothing)  # with no timer of its own, asyncio would wait for a descriptor

    def follow(self, next_ns: Callable[[], int | None], play: Callable[[], None]) -> None:
        """Go from moment to moment, until there are no more.

        Args:
            next_ns: when the next moment is; None after the last.
            play: lets it take effect.
        """
        self._next_ns, self._play = next_ns, play

    def pass_to(self, time_ns: int) -> None:
        """Let the time of a moment come that is played while the effects of another are not over."""
        self._now_ns = max(self._now_ns, time_ns)

    def call_at(  # type: ignore[override]  # typeshed has the loop's TypeVarTuple here
        self, when: float, callback: Callable[..., object], *args: Any, context: Context | None = None
    ) -> asyncio.TimerHandle:
        """Call a function at a time; those of the same time in the order in which they were asked for."""
        timer = asyncio.TimerHandle(when, callback, args, self, context)
        # With a number: handles cannot be compared, and of equal times the first asked for comes first.
        heapq.heappush(self._timers, (when, next(self._numbers), timer))
        return timer

    def _jump(self, by_s: float) -> None:
        """Do the one thing that comes next; called whenever nothing is ready."""
        # Passed over here and not taken out when they are cancelled: most are, and a heap is not searched for
        # each.
        while self._timers and self._timers[0][2].cancelled():
            heapq.heappop(self._timers)
        due_ns = round(self._timers[0][0] * NS_PER_S) if self._timers else None
        next_ns = self._next_ns()
        # A timer before the next moment waits for it: the living loop did nothing in between, or it would be recorded.
        if due_ns is not None and (due_ns <= self._now_ns or next_ns is None):
            self._now_ns = max(self._now_ns, due_ns)
            self.call_soon(_fire, heapq.heappop(self._timers)[2])
        elif next_ns is not None:
            self._now_ns = max(self._now_ns, next_ns)
            self.call_soon(self._play)
        else:
            raise RuntimeError("virtual time is stuck: the recording is over and no timer is set")


def _never() -> int | None:
    return None


def _nothing() -> None:
    """Have no effect."""


def _fire(timer: asyncio.TimerHandle) -> None:
    if not timer.cancelled():
        timer._run()  # noqa: SLF001  # a loop runs its handles; asyncio's own does the same


def pass_to(time_ns: int) -> None:
    """Let a recorded time come, where it takes effect; does nothing on a loop that plays no recording."""
    loop = asyncio.get_running_loop()
    if isinstance(loop, RecordedTimeLoop):
        loop.pass_to(time_ns)


def run_recorded(main: Coroutine[Any, Any, T], *, start_ns: int) -> T:
    """Run a coroutine that plays a recording to its end, and return its result."""
    with asyncio.Runner(loop_factory=lambda: RecordedTimeLoop(start_ns)) as runner:
        return runner.run(main)
