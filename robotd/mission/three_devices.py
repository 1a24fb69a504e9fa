"""The three devices as one robot."""

from dataclasses import dataclass

from robotd.contract.device_status import LinkState
from robotd.hardware.devices.device import Device
from robotd.hardware.devices.drive import Drive
from robotd.hardware.devices.pantilt import PanTilt
from robotd.hardware.devices.rangefinder import Rangefinder


@dataclass(frozen=True, slots=True)
class Robot:
    """What the mission commands."""

    drive: Drive
    pantilt: PanTilt
    rangefinder: Rangefinder

    @property
    def devices(self) -> tuple[Device, ...]:
        """All of them, the one that can hurt somebody first."""
        return self.drive, self.pantilt, self.rangefinder

    @property
    def absent(self) -> tuple[str, ...]:
        """Names of the devices that cannot be talked to now."""
        return tuple(device.name for device in self.devices if device.status.link is not LinkState.READY)

    @property
    def has_base(self) -> bool:
        """Whether there is a base to talk to; without one the robot can still look round where it stands."""
        return self.drive.status.link is LinkState.READY

    @property
    def faults(self) -> tuple[str, ...]:
        """Latched faults as ``device: fault``."""
        return tuple(f"{device.name}: {fault}" for device in self.devices for fault in device.status.faults)

    def stop_past_loop(self, before: int = 0) -> None:
        """Put stop on every wire from any thread, while the event loop is stuck; see :class:`Device`."""
        for device in self.devices:
            device.stop_past_loop(before)

    def stop_now(self) -> None:
        """Put stop on every wire, at once."""
        for device in self.devices:
            device.stop_now()
