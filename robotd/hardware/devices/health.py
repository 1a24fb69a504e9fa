"""What a device says of itself, and who is told when it changes."""

from collections.abc import Callable
from dataclasses import replace

from robotd.core.broadcast import Broadcast
from robotd.hardware.devices.device import DeviceStatus, LinkState

Counted = tuple[tuple[str, int], ...]


class Health:
    """The status of one device; counters alone are no change."""

    def __init__(self, name: str, counted: Callable[[], Counted]) -> None:
        """Begin with nothing started; ``counted`` gives the counters of the line at any time."""
        self._counted = counted
        self._status = DeviceStatus(name, LinkState.ABSENT, armed=False, detail="not started")
        self.changes: Broadcast[DeviceStatus] = Broadcast()

    @property
    def status(self) -> DeviceStatus:
        """It, now."""
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
            detail=before.detail if detail is None else detail,
        )
        if self._status != before:
            self.changes.publish(self.status)
