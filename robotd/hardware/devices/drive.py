"""The synchro-drive base, in SI units."""

from dataclasses import dataclass
from typing import Protocol

from robotd.core.broadcast import Broadcast
from robotd.core.pose import Odometry, Twist2
from robotd.hardware.devices.device import Device


@dataclass(frozen=True, slots=True)
class DriveReadout:
    """Battery and bumpers."""

    time_ns: int
    """When it was measured, or when a device without a clock said so; clock of this host."""
    battery_v: float | None
    """None while it is not known: a base may tell of its bumpers first."""
    bumpers_rad: tuple[float, ...]
    """Directions of the pressed bumpers in the robot frame."""


class Drive(Device, Protocol):
    """A base that translates along its heading and rotates on the spot."""

    @property
    def odometry(self) -> Broadcast[Odometry]:
        """Wheel-derived pose, periodic. Restarts at the origin of ``odom`` with the daemon, not with the board."""

    @property
    def readouts(self) -> Broadcast[DriveReadout]:
        """Battery and bumpers, periodic and on change; the latest is forgotten with the line."""

    @property
    def is_driven(self) -> bool:
        """Whether a set-point other than standstill was given, and no stop since; may be asked from any thread."""

    def set_velocity(self, twist: Twist2, ttl_s: float) -> None:
        """Send a set-point that the base may follow for ``ttl_s``; the newest wins, none is resent.

        Raises:
            TransportError: the device is absent.
        """
