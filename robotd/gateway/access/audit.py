"""Who did what, from where, and what came of it: the log has it for good, and the console shows the last of it."""

import logging
from collections import deque

import msgspec

from robotd.core.text import printable

_MOST = 1000

log = logging.getLogger("robotd.gateway.audit")


class Deed(msgspec.Struct, frozen=True):
    """One line of the audit."""

    time_unix_ns: int
    who: str
    """Name of the token."""
    whence: str
    """Address."""
    what: str
    result: str


class Audit:
    """The last deeds."""

    def __init__(self) -> None:
        self._deeds: deque[Deed] = deque(maxlen=_MOST)

    def note(self, time_unix_ns: int, who: str, whence: str, what: str, result: str) -> Deed:
        """Note what somebody did, in the log and among the last thousand; return it as one line."""
        # Printable before it is kept: names and addresses come from outside, and are shown in a terminal.
        deed = Deed(time_unix_ns, printable(who), printable(whence), printable(what), printable(result))
        self._deeds.append(deed)
        log.info("%s from %s: %s: %s", deed.who, deed.whence, deed.what, deed.result)
        return deed

    @property
    def all(self) -> tuple[Deed, ...]:
        """What is remembered, the oldest first."""
        return tuple(self._deeds)
