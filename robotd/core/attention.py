"""For how long this loop stood still: what tells a partner that is silent from ears that were shut.

A loop that stood still finds timers due whose messages wait unread. So whoever bounds a silence asks here first
(:mod:`robotd.core.silence`), and whoever reads asks before it takes what it read: then a stall is always noted before
anything that happened after it, live and in a replay alike.
"""

import asyncio
from collections.abc import Callable
from weakref import WeakKeyDictionary

_OF_LOOP: "WeakKeyDictionary[asyncio.AbstractEventLoop, Attention]" = WeakKeyDictionary()


class Attention:
    """What one loop missed; nothing, until somebody watches it."""

    def __init__(self) -> None:
        self.missed_s = 0.0
        """How long it stood still in all."""
        self._look: Callable[[], None] = _nothing

    def watch(self, look: Callable[[], None] | None) -> None:
        """Let ``look`` find out whether the loop stood still just now, and call :meth:`miss`; None ends it."""
        self._look = _nothing if look is None else look

    def look(self) -> None:
        """Note a stall that has just ended, if there was one."""
        self._look()

    def miss(self, seconds: float) -> None:
        """Note that the loop stood still for so long."""
        self.missed_s += seconds


def attention() -> Attention:
    """Return that of the running loop."""
    return _OF_LOOP.setdefault(asyncio.get_running_loop(), Attention())


def _nothing() -> None:
    """Nobody watches."""
