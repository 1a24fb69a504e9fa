"""What a device says of itself, and who is told when it changes."""

import logging
from collections.abc import Callable
from dataclasses import replace

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.core.broadcast import Broadcast
from robotd.core.log_limit import LogLimit
from robotd.core.text import printable

Counted = tuple[tuple[str, int], ...]
_LONGEST_DETAIL = 300
"""Letters of a detail that are kept: what a device says when it introduces itself may be anything, and endless."""

log = logging.getLogger(__name__)


class Health:
    """The status of one device; counters alone are no change."""

    def __init__(self, name: str, counted: Callable[[], Counted]) -> None:
        """Begin with nothing started; ``counted`` gives the counters of the line at any time."""
        self._counted = counted
        self._status = DeviceStatus(name, LinkState.ABSENT, armed=False, detail="not started")
        self.changes: Broadcast[DeviceStatus] = Broadcast()
        self._said = ""
        self._limit = LogLimit(burst=20, every_s=10.0)

    @property
    def status(self) -> DeviceStatus:
        """It, now."""
        # Counters join here, and not where changes are looked for: each byte would be one.
        return replace(self._status, counters=self._counted())

    @property
    def faults(self) -> tuple[str, ...]:
        """The latched ones."""
        return self._status.faults

    @property
    def detail(self) -> str:
        """One line for people."""
        return self._status.detail

    def change(
        self,
        *,
        link: LinkState | None = None,
        armed: bool | None = None,
        faults: tuple[str, ...] | None = None,
        detail: str | None = None,
    ) -> None:
        """Note what is new, and tell those who listen if anything is."""
        before = self._status
        self._status = replace(
            before,
            link=before.link if link is None else link,
            armed=before.armed if armed is None else armed,
            faults=before.faults if faults is None else faults,
            detail=before.detail if detail is None else printable(detail, _LONGEST_DETAIL),
        )
        if self._status != before:
            self._say()
            self.changes.publish(self.status)

    def _say(self) -> None:
        """Let the log know whether the device is there; each vain attempt to reach it is no news."""
        status = self._status
        if status.link is LinkState.CONNECTING:
            return
        words = "ready" if status.link is LinkState.READY else f"absent: {status.detail}"
        if words != self._said:
            self._said = words
            if line := self._limit.line(f"{status.name} is {words}"):
                log.info("%s", line)
