"""Virtual time that passes from one recorded moment to the next.

A living loop is sometimes late: when the machine is busy, bytes and timers that fell due one after the other are
found together, and the bytes are served first. A replay is never late, so its timers would fire between two
recorded moments although the living ones did not, and give up requests that were answered in time. But whatever
a timer did that mattered was written to a line or noted as a result, and so is a recorded moment itself.
Hence nothing but recorded moments exists here: what falls due between two of them happens at the later one, after what
was recorded there.
"""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

from robotd.core.clock import VirtualClockLoop

T = TypeVar("T")


class RecordedTimeLoop(VirtualClockLoop):
    """A virtual loop that can be led through recorded moments."""

    def __init__(self, start_ns: int) -> None:
        super().__init__(start_ns)
        self._next_ns: Callable[[], int | None] | None = None
        self._play: Callable[[], None] | None = None

    def follow(self, next_ns: Callable[[], int | None], play: Callable[[], None]) -> None:
        """Go from moment to moment, until there are no more.

        Args:
            next_ns: when the next moment is; None after the last.
            play: lets it take effect.
        """
        self._next_ns, self._play = next_ns, play

    def _jump(self, by_s: float) -> None:
        next_ns = self._next_ns() if self._next_ns is not None else None
        if next_ns is None or self._play is None:
            super()._jump(by_s)
            return
        self._now_ns = max(self._now_ns, next_ns)
        self.call_soon(self._play)  # ahead of the timers that are due by now, as a descriptor's callback would be


def run_recorded(main: Coroutine[Any, Any, T], *, start_ns: int) -> T:
    """Run a coroutine that plays a recording to its end, and return its result."""
    with asyncio.Runner(loop_factory=lambda: RecordedTimeLoop(start_ns)) as runner:
        return runner.run(main)
