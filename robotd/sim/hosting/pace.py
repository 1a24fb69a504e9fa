"""Simulated time: the host's, except that it slows down when the simulator got no processor.

Real boards have processors of their own. A simulator that stood still for half a second would find every deadman due
before it could read the set-points that wait, or send the odometry that brings the next ones: it would simulate a
defect of this machine. So time lost stands still for the robot, and is made up for little by little afterwards. The
boards' clocks fall behind meanwhile and catch up again, so the daemon, which goes by most of what it heard of a clock,
keeps its idea of them.
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
"""No further: a daemon takes a clock that stays half a second behind for a liar."""
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
        if late_ns > LATE_NS:
            self._due_ns = host_ns + BEAT_NS  # or the next look would count the same lateness again
            self._lose(min(late_ns, passed_ns))  # what was late before the last look is counted already
        else:
            self._behind_ns = max(0, self._behind_ns - round(passed_ns * (CATCHING_UP - 1.0)))
        return host_ns - self._behind_ns

    def wait_s(self, until_ns: int) -> float:
        """See :class:`Time`."""
        left_ns = max(0, until_ns - self.now_ns())
        return left_ns / (CATCHING_UP if self._behind_ns else 1.0) / NS_PER_S

    def _lose(self, lost_ns: int) -> None:
        self._behind_ns = min(self._behind_ns + lost_ns, MOST_BEHIND_NS)
        if not self._has_said:
            self._has_said = True
            self._say(SLOWED)
