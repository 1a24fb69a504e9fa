"""A mission is held: it was interrupted for a moment, the base was stopped, and the mission goes on by itself.

The one way back to motion that needs no ``arm``, hence narrow: it begins only in a mission under way, and only because
our own loop stood still, or because odometry fell silent on a line that is not lost, and set-points with it; every
stop, fault, lost device and expired lease ends it, and then only ``arm`` leads on; and it begins no more than
:data:`HOLDS_A_MINUTE` times within a minute.
"""

import asyncio
from collections import deque
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import NoReturn, TypeVar

from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import LinkTimeout, RobotdError

T = TypeVar("T")

TOO_BUSY = "this machine was too busy"
HOLDS_A_MINUTE = 6
"""One more within a minute ends the mission: what happens so often is no longer a moment's interruption."""
WELL_S = 1.0
"""A held mission goes on once the loop has turned for so long without a stall: a machine that was too busy once is
likely to be so again within the second (decision 22)."""
_MINUTE_NS = 60 * NS_PER_S
LATELY_NS = 2 * NS_PER_S
"""What goes wrong this soon after a stall is put down to it: some things show late, as that a deadman ran out."""


@dataclass(frozen=True, slots=True)
class Stall:
    """The loop stood still."""

    time_ns: int
    """When it turned again."""
    stood_still_s: float
    was_stopped: bool
    """Whether a stop was put on the wires meanwhile, because the base was driven."""
    log: str
    """Where people find more."""

    def __str__(self) -> str:
        """Say it in a line."""
        return f"{TOO_BUSY}: the loop stood still {self.stood_still_s:.1f} s; log: {self.log}"

    def is_recent(self, time_ns: int) -> bool:
        """Whether what happens at this time may have come of it."""
        return time_ns - self.time_ns <= LATELY_NS


class Interrupted(Exception):  # no error: the step is taken again
    """A hold broke into a step of the mission."""


class FellSilent(LinkTimeout):
    """No odometry came; whether the base is waited for is decided where the step can be taken again."""


def _not_waited_for(error: FellSilent) -> NoReturn:
    raise error


class Hold:
    """Whether the mission is held, why, and since when all is well."""

    def __init__(self) -> None:
        self.cause: str | None = None
        self.is_ending = False
        """Whether devices are being armed again."""
        self.count = 0
        """How often it began since start."""
        self.unled_ns: int | None = None
        """When a driven base was last found to have got no set-point for too long, because it told no odometry."""
        self.unwell_ns = 0
        """When it was last found that all is not well: the loop stood still, or the base was silent."""
        self.wait_for_base: Callable[[FellSilent], None] = _not_waited_for
        """Begins a hold because odometry fell silent, or raises what ends the mission."""
        self._over = asyncio.Event()
        self._over.set()
        # As long as the limit: then its first is the one that the next would have to be a minute from.
        self._begun_ns: deque[int] = deque(maxlen=HOLDS_A_MINUTE)

    def begin(self, cause: str, time_ns: int) -> bool:
        """Hold the mission; False if that happened too often within a minute, and it must end."""
        # Only beginnings count: a stall within a hold prolongs it, and is not another.
        if self.cause is None and len(self._begun_ns) == HOLDS_A_MINUTE and time_ns - self._begun_ns[0] < _MINUTE_NS:
            return False
        if self.cause is None:
            self._begun_ns.append(time_ns)
            self.count += 1
        # The newest cause is the one that is told, and the wait for all being well begins with it.
        self.cause = cause
        self.unwell_ns = time_ns
        self._over.clear()
        return True

    def set_points_stay_away(self) -> None:
        """Note that nobody leads a base that is driven: its deadman may run out, and does what it is for."""
        self.unled_ns = now_ns()

    def end(self) -> None:
        """Let the mission go on, or end."""
        self.cause = None
        self.is_ending = False
        self._over.set()

    def lasted_s(self, time_ns: int) -> float:
        """Return for how long the mission has been held; 0 if it is not."""
        return 0.0 if self.cause is None else (time_ns - self._begun_ns[-1]) / NS_PER_S

    async def over(self) -> None:
        """Wait until nothing is held."""
        await self._over.wait()

    async def through(self, step: Callable[[], Awaitable[T]]) -> T:
        """Return what came of a step, taken again from its beginning after each hold that broke into it."""
        while True:
            # First: a mission may come to its next step while it is held.
            await self.over()
            # Read just before the step: what is raised counts as interrupted only if a hold began during it.
            count = self.count
            try:
                return await step()
            except FellSilent as error:
                # Had a hold begun meanwhile, the silence would be of its stop, and the step only be taken again.
                if self.count == count:
                    self.wait_for_base(error)
            except (Interrupted, RobotdError):
                if self.count == count:
                    raise  # devices that were stopped for a hold say so; else it is a failure
