"""Watches the devices: what each says of itself decides whether the robot goes on, stops, or has a fault."""

from collections.abc import Callable
from dataclasses import replace

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.modes import Mode
from robotd.hardware.devices.credible import IMPLAUSIBLE
from robotd.hardware.devices.device import Device
from robotd.mission.safety.arming import Arming
from robotd.mission.safety.battery import low_battery
from robotd.mission.safety.holding import Holding
from robotd.mission.safety.mode_table import Occasion
from robotd.mission.safety.stopper import Stopper


class DeviceWatch:
    """Says stop when a device is lost, at fault, disarmed by itself, or out of battery."""

    def __init__(
        self,
        stopper: Stopper,
        holding: Holding,
        arming: Arming,
        doubt: Callable[[], None],
        battery_min_v: float,
    ) -> None:
        """Prepare to watch.

        Args:
            stopper: what to tell when the robot must stop.
            holding: knows what is disarmed because of us.
            arming: says which devices the last arming was for; the others may come and go.
            doubt: called when nobody saw what the wheels did.
            battery_min_v: below it, stop and latch a fault.
        """
        self._stopper = stopper
        self._robot = stopper.robot
        self._holding = holding
        self._arming = arming
        self._doubt = doubt
        self._battery_min_v = battery_min_v

    async def watch(self, device: Device) -> None:
        """Take up what a device says of itself, until cancelled."""
        with device.status_changes.subscribe() as changes:
            async for status in changes:
                # It may have been armed since, knowing of this change: that is then no news.
                self.changed(replace(status, armed=status.armed or device.status.armed))

    async def watch_battery(self) -> None:
        """Stop when the battery is low, until cancelled."""
        with self._robot.drive.readouts.subscribe() as readouts:
            async for _ in readouts:
                low = low_battery(self._robot.drive, self._battery_min_v)
                # Latched once: the battery stays low, and each readout would be a fault of its own.
                if low is not None and self._stopper.mode is not Mode.FAULT:
                    self._stopper.halt(Occasion.FAULT, low)

    def changed(self, status: DeviceStatus) -> None:
        """Take up that a device is another than before; the first case that fits is the one that counts."""
        if status.name == self._robot.drive.name and (status.link is LinkState.ABSENT or IMPLAUSIBLE in status.faults):
            self._doubt()  # whatever else becomes of it: the wheels may have turned unseen
        is_left_out = self._is_left_out(status)
        is_explained = self._holding.explains(status)  # which may stop the robot, so the mode is asked after that
        mode = self._stopper.mode
        if is_explained and not is_left_out:
            self._stopper.publish_status()
        # Also while disarmed, where nothing is to be stopped: `arm` is refused until the fault is cleared.
        elif status.faults and mode is not Mode.FAULT:
            why = f": {status.detail}" if IMPLAUSIBLE in status.faults else ""
            self._fail(f"{status.name}: {', '.join(status.faults)}{why}", Occasion.FAULT)
        elif mode in {Mode.DISARMED, Mode.FAULT}:
            self._stopper.publish_status()
        # What arming left out may come and go: an absent base is no news to a robot that only looks.
        elif status.link is not LinkState.READY and not is_left_out:
            self._fail(f"{status.name} is gone: {status.detail}", Occasion.DEVICE_LOST)
        # A board that was reset is there, and not armed: nothing more is known of it, so somebody must arm it
        # again.
        elif status.link is LinkState.READY and not status.armed:
            why = "there again: arm again" if is_left_out else "no longer armed"
            self._stopper.halt(Occasion.STOP, f"{status.name} is {why}")
        else:
            self._stopper.publish_status()

    def _fail(self, reason: str, occasion: Occasion) -> None:
        self._stopper.halt(occasion, self._holding.blamed(reason))

    def _is_left_out(self, status: DeviceStatus) -> bool:
        return status.name not in {device.name for device in self._arming.armed}
