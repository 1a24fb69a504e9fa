"""Arming and clearing: the only ways from standing still to being allowed to move, and both are asked for."""

from collections.abc import Callable

from robotd.contract.device_status import LinkState
from robotd.core.errors import LinkTimeout, MissionError
from robotd.core.silence import within
from robotd.hardware.devices.device import Device
from robotd.mission.safety.current_mode import CurrentMode
from robotd.mission.safety.mode_table import Occasion
from robotd.mission.safety.stopper import Stopper

_DEVICE_TIMEOUT_S = 5.0
"""For all devices together; the client waits 10 s for its answer."""


class Arming:
    """Arms devices, all or none, and remembers which."""

    def __init__(self, stopper: Stopper, current: CurrentMode, faults: Callable[[], tuple[str, ...]]) -> None:
        """Arm the devices of a robot; ``faults`` says what must be cleared first."""
        self._stopper = stopper
        self._robot = stopper.robot
        self._current = current
        self._faults = faults
        self._armed: tuple[Device, ...] = ()

    @property
    def armed(self) -> tuple[Device, ...]:
        """What the last arming was for: everything, or everything but the base."""
        return self._armed

    async def arm(self) -> None:
        """Allow motion, on every device or on none; without a base, on the others.

        Raises:
            MissionError: the head or the rangefinder is absent, a fault is latched, or a mission is under way.
            DeviceError, LinkTimeout, TransportError: a device will not; all are disarmed again.
        """
        devices = self.require_armable()
        try:
            async with within(_DEVICE_TIMEOUT_S, of="arming"):
                await self.arm_these(devices)
        except TimeoutError:
            self._stopper.halt(Occasion.STOP, "arming took too long")
            raise LinkTimeout(f"arming took longer than {_DEVICE_TIMEOUT_S:g} s") from None
        # Cancellation, too: that is how a stop overtakes an arm, and some devices may be armed by then.
        except BaseException as error:
            self._stopper.halt(Occasion.STOP, f"arming failed: {str(error) or 'given up'}")
            raise
        self._armed = devices
        has_base = self._robot.drive in devices
        self._current.apply(Occasion.ARM, "armed" if has_base else "armed without a base: it can only look")

    def require_armable(self) -> tuple[Device, ...]:
        """Return what to arm: all devices; without a base the others, so that the robot can look round where it stands.

        Raises:
            MissionError: it cannot be armed now; nothing was done yet.
        """
        self._current.require(Occasion.ARM)
        absent = self._robot.absent
        # The base is the first of them.
        devices = self._robot.devices if self._robot.has_base else self._robot.devices[1:]
        if any(device.name in absent for device in devices):
            raise MissionError(f"cannot arm: {', '.join(absent)} absent; what is wrong with it: robotctl status")
        if faults := self._faults():
            raise MissionError(f"cannot arm: {'; '.join(faults)}: clear first, with: robotctl clear")
        return devices

    async def arm_these(self, devices: tuple[Device, ...]) -> None:
        """Arm these devices one by one; the mode stays as it is.

        Raises:
            MissionError: the robot was stopped meanwhile, or a device was lost: a stop that comes while devices are
                being armed wins, whichever of them it found armed.
            DeviceError, LinkTimeout, TransportError: a device will not.
        """
        halts = self._stopper.halts
        for device in devices:
            await device.arm()
            # A stop came while this device answered: arming the next one would undo it.
            if self._stopper.halts != halts:
                raise MissionError(f"stopped while arming: {self._current.reason}")
        # Asked of the devices, not of their answers: one that was armed first may have been lost while the last
        # one answered.
        if not all(device.status.armed for device in devices):
            raise MissionError("a device was lost while the others were arming")

    def require_clearable(self) -> None:
        """Raise MissionError if faults cannot be acknowledged now; nothing was done yet."""
        self._current.require(Occasion.CLEAR)

    async def clear(self) -> None:
        """Acknowledge latched faults; the robot stays disarmed.

        Raises:
            MissionError: the robot is armed, or a fault stays.
            DeviceError, LinkTimeout, TransportError: a device will not.
        """
        self.require_clearable()
        for device in self._robot.devices:
            # What is not there has nothing to acknowledge, and must not keep the others at fault.
            if device.status.link is LinkState.READY:
                await device.clear_faults()
        # Looked up after clearing: a bumper that is still pressed latches again at once, and that must be said.
        if faults := self._faults():
            raise MissionError(f"faults remain: {'; '.join(faults)}; mend that, then: robotctl clear")
        self._current.apply(Occasion.CLEAR, "faults cleared")
