"""For how long this loop stood still, and whose silence it waits for.

A loop that stood still finds timers due whose messages wait unread. So anyone who bounds a silence asks here first
(:mod:`robotd.core.silence`), and anyone who reads asks before it takes what it read: then a stall is always noted
before anything that happened after it, live and in a replay alike.

Whether a timer that is due or bytes that wait come first is up to the machine. So each silence that fell is told, for
the journal, and a replay lets each fall where it fell.
"""

import asyncio
from collections import defaultdict
from collections.abc import Callable
from typing import Protocol
from weakref import WeakKeyDictionary

_OF_LOOP: "WeakKeyDictionary[asyncio.AbstractEventLoop, Attention]" = WeakKeyDictionary()
"""One for each loop, gone with it: in one process tests and replays run many, and share nothing."""


class Awaited(Protocol):
    """A silence that may fall."""

    of: str
    due_s: float

    def fall(self) -> None:
        """Let it fall now."""


class Attention:
    """What one loop missed, and what it waits for; nothing, until somebody watches it."""

    def __init__(self) -> None:
        self.missed_s = 0.0
        """How long it stood still in all."""
        self.are_led = False
        """Whether silences fall when :meth:`let_fall` says so, and never by themselves."""
        self.fell: Callable[[str], None] = _ignored
        """Told of each silence that falls whose it was, before that has any effect."""
        self._look: Callable[[], None] = _nothing
        self._awaited: defaultdict[str, list[Awaited]] = defaultdict(list)

    def watch(self, look: Callable[[], None] | None) -> None:
        """Let ``look`` find out whether the loop stood still just now, and call :meth:`miss`; None ends it."""
        self._look = _nothing if look is None else look

    def look(self) -> None:
        """Note a stall that has just ended, if there was one."""
        self._look()

    def miss(self, seconds: float) -> None:
        """Note that the loop stood still for so long."""
        self.missed_s += seconds

    def wait_for(self, silence: Awaited) -> None:
        """Keep a silence that is led."""
        self._awaited[silence.of].append(silence)

    def give_up(self, silence: Awaited) -> None:
        """Wait for a silence no longer."""
        if silence in self._awaited[silence.of]:
            self._awaited[silence.of].remove(silence)

    def let_fall(self, of: str) -> None:
        """Let the silence fall that is due first among those of one name; nothing happens where there is none."""
        awaited = self._awaited[of]
        if awaited:
            # Several may bear one name, as the requests of one device do; the living loop let the one fall that
            # was due first.
            silence = min(awaited, key=lambda one: one.due_s)
            # Taken out first: what its fall leads to may wait for another of the same name.
            awaited.remove(silence)
            silence.fall()


def attention() -> Attention:
    """Return that of the running loop."""
    return _OF_LOOP.setdefault(asyncio.get_running_loop(), Attention())


def _nothing() -> None:
    """Nobody watches."""


def _ignored(of: str) -> None:
    """Nobody notes it."""
