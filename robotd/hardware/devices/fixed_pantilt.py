"""A head without a motor, for robots with a scanner: it turns by choosing one of the directions that are measured.

It has no line, so it is always there; what it can aim at is known once the scanner is.
"""

import asyncio
from typing import ClassVar

from robotd.contract.device_status import LinkState
from robotd.core.angles import wrap_rad
from robotd.core.clock import now_ns
from robotd.core.errors import DeviceError, TransportError
from robotd.hardware.devices.dialect_options import FixedHeadSettings
from robotd.hardware.devices.gaze import Fan
from robotd.hardware.devices.health import Health
from robotd.hardware.devices.pantilt import AimReadback, PanTiltLimits
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.devices.with_health import WithHealth


class FixedPanTilt(WithHealth):
    """Implements :class:`robotd.hardware.devices.pantilt.PanTilt`."""

    NAME: ClassVar[str] = "pantilt"

    def __init__(self, settings: FixedHeadSettings, wiring: Wiring) -> None:
        """Make the device; the zeros of its mount say how the scanner sits on the robot."""
        self._settings = settings
        self._mount = settings.mount
        self._gaze = wiring.gaze
        self._health = Health(self.NAME, lambda: ())
        self._is_armed = False

    @property
    def name(self) -> str:
        """``pantilt``."""
        return self.NAME

    async def run(self) -> None:
        """Be there until cancelled."""
        self._health.change(link=LinkState.READY, detail="")
        try:
            await asyncio.get_running_loop().create_future()
        finally:
            self.stop_now()
            self._health.change(link=LinkState.ABSENT, detail="shut down")

    async def arm(self) -> None:
        """Allow aiming; TransportError if it is not running."""
        if self.status.link is not LinkState.READY:
            raise TransportError(f"{self.NAME} is absent: {self._health.detail}")
        self._is_armed = True
        self._health.change(armed=True)

    async def clear_faults(self) -> None:
        """Leave it disarmed; it has no faults."""
        self.stop_now()

    async def reset(self) -> None:
        """Do nothing: it cannot lose steps."""

    def stop_now(self) -> None:
        """Allow no aiming until the next :meth:`arm`; nothing moves."""
        self._is_armed = False
        self._health.change(armed=False)

    def stop_past_loop(self, before: int = 0) -> None:
        """Allow no aiming; nothing moves."""
        self._is_armed = False

    async def limits(self) -> PanTiltLimits:
        """Return what the scanner sees, within the settings, in the robot frame."""
        fan, zero_rad = self._fan(), self._mount.pan_zero_rad
        return PanTiltLimits(
            max(fan.first_rad + zero_rad, self._settings.pan_min_rad),
            min(fan.last_rad + zero_rad, self._settings.pan_max_rad),
            self._mount.tilt_zero_rad,
            self._mount.tilt_zero_rad,
        )

    async def aim(self, pan_rad: float, tilt_rad: float, *, timeout_s: float) -> AimReadback:
        """Choose the nearest direction that is measured, whatever the tilt; see :class:`.PanTilt`."""
        if not self._is_armed:
            raise DeviceError(self.NAME, "not_armed", "arm first")
        fan, zero_rad = self._fan(), self._mount.pan_zero_rad
        # As it was asked for first: a fan may reach past the half turn, where wrapping would lead out of it.
        for same_rad in (pan_rad, wrap_rad(pan_rad)):
            index = fan.nearest(same_rad - zero_rad)
            if index is not None and self._settings.pan_min_rad <= same_rad <= self._settings.pan_max_rad:
                self._gaze.index = index
                return AimReadback(now_ns(), fan.direction_rad(index) + zero_rad, self._mount.tilt_zero_rad)
        raise DeviceError(self.NAME, "out_of_range", f"nothing is measured at pan {pan_rad:.3f} rad")

    def _fan(self) -> Fan:
        if self._gaze.fan is None:
            raise TransportError(f"{self.NAME} is absent: the scanner has not said yet where it looks")
        return self._gaze.fan
