"""The laser rangefinder, in SI units."""

from dataclasses import dataclass
from typing import Protocol

from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.device import Device


@dataclass(frozen=True, slots=True)
class Shot:
    """One measurement along the beam, before it is laid into the robot frame."""

    time_ns: int
    """When it was measured, or when a device without a clock said so; clock of this host."""
    status: ReadingStatus
    range_m: float | None
    """Distance along the beam, range bias applied; of a miss, how far nothing was met, None if the device does not say;
    None for every other status."""
    strength: int | None
    """As the device counts it, which differs from model to model; None if it tells none."""


class Rangefinder(Device, Protocol):
    """A point-and-shoot laser."""

    async def switch_laser(self, *, on: bool) -> None:
        """Switch the light; same errors as :meth:`Device.arm`.

        What was measured before counts no more: it must be done whenever the robot has moved.
        """

    async def shoot(self, *, timeout_s: float) -> Shot:
        """Take one reading. A reading that failed is a result, with its status.

        Raises:
            TransportError: the device is absent.
        """
