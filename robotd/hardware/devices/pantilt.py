"""The pan/tilt unit, in SI units."""

from dataclasses import dataclass
from typing import Protocol

from robotd.hardware.devices.device import Device

LOST_STEPS = "lost_steps"
"""Code of the DeviceError of a head that met a stop: it does not know where it points."""


@dataclass(frozen=True, slots=True)
class PanTiltLimits:
    """How far the head turns. A pan range of a full turn or more needs no turn of the base."""

    pan_min_rad: float
    """Rightmost; pan counts counter-clockwise from the robot's heading."""
    pan_max_rad: float
    tilt_min_rad: float
    """Lowest; tilt counts up from level."""
    tilt_max_rad: float


@dataclass(frozen=True, slots=True)
class AimReadback:
    """Where the head points, as measured."""

    time_ns: int
    """When it was measured, or when a device without a clock said so; clock of this host."""
    pan_rad: float
    """Counter-clockwise from the robot's heading (pan zero applied)."""
    tilt_rad: float
    """Up from level."""


class PanTilt(Device, Protocol):
    """A head that turns to a setpoint and says where it came to rest."""

    async def limits(self) -> PanTiltLimits:
        """Return the mechanical limits, in the robot frame (pan zero applied)."""

    async def aim(self, pan_rad: float, tilt_rad: float, *, timeout_s: float) -> AimReadback:
        """Turn the head and return where it came to rest.

        Raises:
            DeviceError: outside the limits, not armed, or a fault; the code :data:`LOST_STEPS` if it does not know
                where it points, until it was reset.
            LinkTimeout: still turning, or silent, after ``timeout_s``; the head was told to halt.
            TransportError: the device is absent.
        """

    async def reset(self) -> None:
        """Find out again where it points, after it lost steps; it may turn to its stops, and take half a minute.

        A head that cannot lose steps does nothing. Same errors as :meth:`aim`.
        """
