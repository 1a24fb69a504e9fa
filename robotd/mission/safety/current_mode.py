"""The mode the robot is in, and why: changed by occasions alone, as the table of modes allows."""

import logging
from collections.abc import Callable

from robotd.contract.modes import Mode
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import MissionError
from robotd.core.log_limit import LogLimit
from robotd.core.text import printable
from robotd.mission.safety.mode_table import Occasion, next_mode

_LONGEST_REASON = 500
"""Letters: reasons quote devices and clients, and stand in every status."""

_NEXT = {
    Mode.FAULT: "; when that is mended: robotctl clear, then robotctl arm",
    Mode.UNDER_WAY: "; wait for its end, or end it: robotctl stop",
}
"""What people do next where something is refused."""

log = logging.getLogger(__name__)


class CurrentMode:
    """What the robot is allowed to do now."""

    def __init__(self, tell: Callable[[], None]) -> None:
        """Begin disarmed; ``tell`` is called after each occasion that counted, whether the mode changed or not."""
        self._tell = tell
        self._mode = Mode.DISARMED
        self._doing = ""
        """What the mission does that is under way, or was last."""
        self._reason = "started"
        self.since_ns = now_ns()
        """When it came into this mode."""
        self._changes = LogLimit(burst=50)  # a device that flutters must not fill the disk

    @property
    def mode(self) -> Mode:
        """What the robot is allowed to do."""
        return self._mode

    @property
    def word(self) -> str:
        """The mode as a status says it: of a mission under way, what it does."""
        return self._doing if self._mode is Mode.UNDER_WAY else self._mode

    @property
    def reason(self) -> str:
        """Why it is in this mode, for people."""
        return self._reason

    @property
    def age_in_words(self) -> str:
        """For how long it has been in this mode."""
        seconds = (now_ns() - self.since_ns) / NS_PER_S
        return f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"

    def require(self, occasion: Occasion, what: str = "") -> None:
        """Raise MissionError if an occasion, in words ``what``, is refused in this mode; nothing was done yet."""
        if next_mode(self._mode, occasion) is None:
            why = f": {self._reason}" if self._mode in {Mode.DISARMED, Mode.FAULT} else ""
            raise MissionError(f"cannot {what or occasion} while {self.word}{why}{_NEXT.get(self._mode, '')}")

    def start(self, doing: str, reason: str) -> None:
        """Let a mission begin; ``doing`` is the word for what it does."""
        self._doing = doing
        self.apply(Occasion.START, reason)

    def apply(self, occasion: Occasion, reason: str) -> None:
        """Go where an occasion leads; what the table refuses changes nothing, and is not told."""
        mode = next_mode(self._mode, occasion)
        if mode is None:
            return
        reason = printable(reason, _LONGEST_REASON)
        if mode is self._mode is Mode.FAULT:
            reason = self._reason  # what comes after a fault does not explain it
        before, was = self.word, (self._mode, self._reason)
        # Only where it changes: the age that is told is that of the mode, not of the last thing said about it.
        if mode is not self._mode:
            self.since_ns = now_ns()
        self._mode, self._reason = mode, reason
        # A stop that is said ten times a second is one line.
        if (mode, reason) != was and (line := self._changes.line(f"{before} -> {self.word}: {reason}")):
            log.info("%s", line)
        self._tell()
