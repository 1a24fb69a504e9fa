"""What the mission may ask of any device, whatever dialect it speaks."""

from typing import Protocol

from robotd.contract.device_status import DeviceStatus
from robotd.core.broadcast import Broadcast

PAST_LOOP_S = 0.015
"""No device needs more time between two orders."""
PAST_LOOP_EVERY = 8
"""Most devices are told again a tenth of a second later: a slow line must not fill up with stops."""


class Device(Protocol):
    """The part that drive, pan/tilt and rangefinder share."""

    @property
    def name(self) -> str:
        """``drive``, ``pantilt`` or ``rangefinder``."""

    @property
    def status(self) -> DeviceStatus:
        """Its health now."""

    @property
    def status_changes(self) -> Broadcast[DeviceStatus]:
        """Its health, whenever it changes."""

    async def run(self) -> None:
        """Own the link until cancelled: connect, serve, reconnect with back-off, never arm by itself."""

    async def arm(self) -> None:
        """Allow motion.

        Raises:
            DeviceError: the device will not, for example because a fault is latched.
            LinkTimeout: no answer.
            TransportError: the device is absent.
        """

    async def clear_faults(self) -> None:
        """Acknowledge latched faults; leaves the device disarmed; same errors as :meth:`arm`."""

    def stop_now(self) -> None:
        """Put the preformatted stop on the wire in place of all that waits; never blocks, never raises.

        Nothing may move until the next :meth:`arm`: should the stop be lost, the device says it again.
        """

    def stop_past_loop(self, before: int = 0) -> None:
        """Put the stop on the wire from any thread, while the event loop is stuck; never blocks, never raises.

        Called again and again, every :data:`PAST_LOOP_S`, for as long as the loop is stuck, as nobody can see whether
        it was obeyed; ``before`` counts how often in this stall. The first call puts down the whole stop, later ones
        what the dialect can do with.

        The device and its callers learn of it by a :meth:`stop_now` as soon as the loop turns again.
        """
