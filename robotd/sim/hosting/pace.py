"""Simulated time: the host's, except that it slows down when the simulator got no processor.

Real boards have processors of their own. A simulator that stood still for half a second would find every deadman due
before it could read the set-points that wait, or send the odometry that brings the next ones: it would simulate a
defect of this machine. So time lost stands still for the robot, and is made up for little by little afterwards. The
boards' clocks fall behind meanwhile and catch up again, so the daemon, which goes by most of what it heard of a clock,
keeps its idea of them. The farther behind, the more quickly; but not before what waited on the lines was read: the
set-points of a daemon that was well, or the stop of one that heard nothing.
"""

import asyncio
from collections.abc import Callable
from typing import NoReturn, Protocol

from robotd.core.clock import NS_PER_S, now_ns

LATE_NS = 50_000_000
"""So late a beat is time lost; less is what every process waits now and then."""
BEAT_NS = 20_000_000
CATCHING_UP = 1.5
"""This many simulated seconds pass in one while time is made up for; set-points still last until they are renewed."""
MOST_BEHIND_NS = 300_000_000
"""Farther behind it hurries: a daemon takes a clock that stays half a second behind for a liar."""
HURRY_NS = 150_000_000
"""In so long it makes up for two thirds of what is too much."""
READING_NS = 40_000_000
"""It does not hurry before nothing was late for so long: what waits on the lines is read meanwhile."""
TOO_LONG_NS = 400_000_000
"""After so long what is still too much is leapt over, for a daemon has patience with a clock for a second."""
LEAP_NS = 200_000_000
"""So far at once at least, or half of what is too much: half of what a set-point lives by default."""
PATIENCE_S = 10.0
"""How long the lines of a simulated robot may be silent (``silence_s``): no cable of it can come off."""
SLOWED = "this machine is busy: simulated time is slowed"


class Time(Protocol):
    """What boards live by."""

    def now_ns(self) -> int:
        """Return the present time; never less than before."""

    def wait_s(self, until_ns: int) -> float:
        """Return how long it is until then."""

    async def beat(self) -> None:
        """Run beside the boards, if it needs to."""


class HostTime:
    """The host's, whatever happens: where it is virtual nothing is ever late."""

    def now_ns(self) -> int:
        """See :class:`Time`."""
        return now_ns()

    def wait_s(self, until_ns: int) -> float:
        """See :class:`Time`."""
        return max(0, until_ns - now_ns()) / NS_PER_S

    async def beat(self) -> None:
        """See :class:`Time`."""


class SlowedTime:
    """Falls behind the host's while its beat is late, and catches up."""

    def __init__(self, say: Callable[[str], None]) -> None:
        """Begin now; ``say`` is told once that time is slowed."""
        self._say = say
        self._has_said = False
        self._seen_ns = now_ns()
        self._due_ns = self._seen_ns + BEAT_NS
        self._behind_ns = 0
        self._late_ns = 0
        self._leaps_ns: int | None = None
        """When it leaps unless it has made up for enough by then; None if it is not too far behind."""

    async def beat(self) -> NoReturn:
        """Let it be seen whether this process gets a processor."""
        while True:
            self.now_ns()
            self._due_ns = now_ns() + BEAT_NS
            await asyncio.sleep(BEAT_NS / NS_PER_S)

    def now_ns(self) -> int:
        """See :class:`Time`."""
        host_ns = now_ns()
        passed_ns, late_ns = host_ns - self._seen_ns, host_ns - self._due_ns
        self._seen_ns = host_ns
        # What was late before the last look is counted already.
        lost_ns = min(late_ns, passed_ns) if late_ns > LATE_NS else 0
        self._make_up(passed_ns - lost_ns)
        was_read = host_ns - lost_ns - self._late_ns >= READING_NS
        if lost_ns:
            self._due_ns = host_ns + BEAT_NS  # or the next look would count the same lateness again
            self._lose(lost_ns)
        # What a loss left to be read is read before it leaps; where each look finds another, nothing ever is.
        if was_read != bool(lost_ns):
            self._bound(leap_ns=self._behind_ns if lost_ns else LEAP_NS)
        return host_ns - self._behind_ns

    def wait_s(self, until_ns: int) -> float:
        """See :class:`Time`."""
        left_ns = max(0, until_ns - self.now_ns())
        return left_ns / self._rate() / NS_PER_S

    def _rate(self) -> float:
        """Return how many simulated seconds pass in one."""
        if not self._behind_ns:
            return 1.0
        if self._seen_ns - self._late_ns < READING_NS:
            return CATCHING_UP
        return CATCHING_UP + max(0, self._behind_ns - MOST_BEHIND_NS) / HURRY_NS

    def _make_up(self, passed_ns: int) -> None:
        self._behind_ns = max(0, self._behind_ns - round(passed_ns * (self._rate() - 1.0)))

    def _lose(self, lost_ns: int) -> None:
        self._behind_ns += lost_ns
        self._late_ns = self._seen_ns
        if not self._has_said:
            self._has_said = True
            self._say(SLOWED)

    def _bound(self, leap_ns: int) -> None:
        """Leap so far, or half of what is too much, if it has been too far behind for too long."""
        if self._behind_ns <= MOST_BEHIND_NS:
            self._leaps_ns = None
        elif self._leaps_ns is None:
            self._leaps_ns = self._seen_ns + TOO_LONG_NS
        elif self._seen_ns >= self._leaps_ns:
            self._leaps_ns = self._seen_ns + BEAT_NS
            leap_ns = max(leap_ns, (self._behind_ns - MOST_BEHIND_NS) // 2)
            self._behind_ns = max(MOST_BEHIND_NS, self._behind_ns - leap_ns)
