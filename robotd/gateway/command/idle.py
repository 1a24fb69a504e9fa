"""Disarming a robot that was armed in a browser and is left standing. Pure."""

from robotd.contract.events import Status
from robotd.contract.modes import Mode


class Idle:
    """How long a robot that was armed here has stood idle."""

    def __init__(self, after_s: float) -> None:
        self._after_s = after_s
        self._is_ours = False
        self._since_s: float | None = None

    def armed(self, now_s: float) -> None:
        """Note that somebody armed it here."""
        self._is_ours, self._since_s = True, now_s

    def accept(self, status: Status, now_s: float) -> bool:
        """Take a status; return whether to disarm the robot now."""
        # A robot that a script armed stands idle for reasons of its own.
        if not self._is_ours:
            return False
        if status.mode in {Mode.DISARMED, Mode.FAULT}:
            self._is_ours = False
        elif status.mode != Mode.IDLE:
            self._since_s = None
        elif self._since_s is None:
            self._since_s = now_s
        elif now_s - self._since_s >= self._after_s:
            self._is_ours = False
            return True
        return False
