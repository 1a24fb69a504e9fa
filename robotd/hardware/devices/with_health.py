"""What every device does with its health, whatever is at the other end of its line."""

import contextlib
from collections.abc import Iterator

from robotd.contract.device_status import DeviceStatus
from robotd.core.broadcast import Broadcast
from robotd.core.errors import DeviceError
from robotd.hardware.devices.credible import IMPLAUSIBLE
from robotd.hardware.devices.health import Health


class WithHealth:
    """Shows its health; a subclass makes it, and says what follows if a device said what cannot be."""

    _health: Health

    @property
    def status(self) -> DeviceStatus:
        """Its health now."""
        return self._health.status

    @property
    def status_changes(self) -> Broadcast[DeviceStatus]:
        """Its health, whenever it changes; counters alone are no change."""
        return self._health.changes

    @contextlib.contextmanager
    def _judging(self) -> Iterator[None]:
        """Distrust the device for what is found implausible within; the error goes on."""
        try:
            yield
        except DeviceError as error:
            if error.code == IMPLAUSIBLE:
                self._distrust(error)
            raise

    def _distrust(self, error: DeviceError) -> None:
        """Stop, count, and latch that it said what cannot be; nothing to do for one that measures nothing."""

    def _unlikely(self) -> int:
        """Return how many values a subclass left out by itself."""
        return 0
