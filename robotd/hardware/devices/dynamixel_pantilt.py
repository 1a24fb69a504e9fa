"""Two Dynamixel servos of the X series as a pan/tilt head.

They measure where they are, so what is read back is true. Their bus watchdog stops them when the host falls silent; it
is armed with the device, and fed by every poll.
"""

import asyncio
import math
from collections.abc import Callable
from typing import ClassVar, NoReturn

from robotd.core.angles import wrap_rad
from robotd.core.errors import DeviceError, LinkTimeout, RemoteProtocolError
from robotd.core.silence import within
from robotd.hardware.devices.dialect_options import DynamixelSettings
from robotd.hardware.devices.pantilt import AimReadback, PanTiltLimits
from robotd.hardware.devices.vendor_device import VendorDevice
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue, Heard
from robotd.hardware.wire import dynamixel
from robotd.hardware.wire.dynamixel import ALERT, DynamixelWire, Message, ServoStatus

# Zero is the middle of a turn, so no goal is near the ends of the counter.
_COUNTS_PER_RAD = 4096 / math.tau
_CENTRE = 2048
_ANSWER_S = 0.1
_TRIES = 3
_IDLE_POLL_S = 0.5
_WATCHDOG_MAX = 127
"""Largest value of its register: 2.54 s."""
_SETTLED_COUNTS = 12
"""A servo under load rests within this many counts of its goal: one degree."""
_HARDWARE = "hardware"
"""What it latches when a servo has shut down."""
_BOOTS_S = 0.3
_BOOT_TRIES = 20
"""A servo is silent for about a quarter of a second when it boots; it is asked for two more."""
_TILT_LIMIT_RAD = math.radians(90.0)


class DynamixelPanTilt(VendorDevice[Message]):
    """Implements :class:`robotd.hardware.devices.pantilt.PanTilt`."""

    NAME: ClassVar[str] = "pantilt"

    def __init__(self, settings: DynamixelSettings, wiring: Wiring) -> None:
        """Make the device; angles outside it have the zeros of its mount applied."""
        super().__init__(DynamixelWire(), wiring)
        self._mount = settings.mount
        self._pan, self._tilt = settings.pan_id, settings.tilt_id
        self._watchdog = min(max(1, settings.ttl_max_ms // dynamixel.BUS_WATCHDOG_MS), _WATCHDOG_MAX)
        # One packet that both obey and neither answers: a stop waits for nobody.
        self.STOP = dynamixel.sync_write(dynamixel.TORQUE_ENABLE, 1, {self._pan: 0, self._tilt: 0})
        self._is_rebooting = False
        """Meanwhile a servo is silent, and still reports the error that its reboot is to end."""
        self._is_enabling = False
        """Meanwhile a servo holds that does not count as armed yet; that is no reason to stop it."""
        self._one_aim = asyncio.Lock()

    async def limits(self) -> PanTiltLimits:
        """Return how far it turns, in the robot frame: all round, and a quarter turn up and down."""
        self._talk()
        low_rad, high_rad = -_TILT_LIMIT_RAD, _TILT_LIMIT_RAD
        zero_rad = self._mount.tilt_zero_rad
        return PanTiltLimits(-math.pi, math.pi, low_rad + zero_rad, high_rad + zero_rad)

    async def reset(self) -> None:
        """Do nothing: it measures where it points."""

    async def aim(self, pan_rad: float, tilt_rad: float, *, timeout_s: float) -> AimReadback:
        """Turn the head and return where it came to rest; see :meth:`robotd.hardware.devices.pantilt.PanTilt.aim`."""
        tilt_of_head_rad = tilt_rad - self._mount.tilt_zero_rad
        if abs(tilt_of_head_rad) > _TILT_LIMIT_RAD:
            raise DeviceError(self.name, "out_of_range", f"tilt {tilt_rad:.3f} rad is beyond the limits")
        async with self._one_aim:
            dialogue = self._talk_armed()
            goals = {
                # Wrapped, as the servo turns less than once round: the same direction may be named from either
                # side.
                self._pan: _counts(wrap_rad(pan_rad - self._mount.pan_zero_rad)),
                self._tilt: _counts(tilt_of_head_rad),
            }
            try:
                async with within(timeout_s, of=f"{self.name} aim"):
                    for servo, goal in goals.items():
                        await self._write(dialogue, servo, dynamixel.GOAL_POSITION, goal, 4)
                    return await self._arrived(dialogue, goals)
            except TimeoutError:
                self.stop_now()
                raise LinkTimeout(f"{self.name}: still turning after {timeout_s:g} s") from None

    async def _arrived(self, dialogue: Dialogue[Message], goals: dict[int, int]) -> AimReadback:
        """Ask where the servos are until both rest at their goals."""
        while True:
            moving, at, time_ns = False, dict[int, int](), 0
            for servo, goal in goals.items():
                moving |= bool((await self._read(dialogue, servo, dynamixel.MOVING, 1))[0])
                at[servo], time_ns = await self._read(dialogue, servo, dynamixel.PRESENT_POSITION, 4)
                moving |= abs(at[servo] - goal) > _SETTLED_COUNTS  # it does not move before it begins to, either
            self._talk_armed()  # reads go on after a stop, aims do not
            if not moving:
                pan_rad, tilt_rad = _rad(at[self._pan]), _rad(at[self._tilt])
                return AimReadback(time_ns, pan_rad + self._mount.pan_zero_rad, tilt_rad + self._mount.tilt_zero_rad)

    async def _greet(self, dialogue: Dialogue[Message]) -> None:
        dialogue.post(self.STOP)
        for servo in (self._pan, self._tilt):
            await dialogue.ask(dynamixel.packet(servo, dynamixel.PING), _from(servo), timeout_s=_ANSWER_S, tries=_TRIES)
            await self._check_hardware(dialogue, servo)

    async def _check_hardware(self, dialogue: Dialogue[Message], servo: int) -> None:
        """Latch what a servo says is wrong with it; it holds and turns nothing until it is rebooted."""
        error, _ = await self._read(dialogue, servo, dynamixel.HARDWARE_ERROR, 1)
        if error:
            self._latch(_HARDWARE)  # that it is, its answer said already; what it is, only the register does
            self._health.change(detail=f"servo {servo}: {dynamixel.hardware_error(error)}: clear reboots it")

    async def _acknowledge(self, dialogue: Dialogue[Message]) -> None:
        """Reboot the servos that shut down: nothing less ends what they have latched."""
        if _HARDWARE not in self._health.faults:
            return
        self._is_rebooting = True
        try:
            for servo in (self._pan, self._tilt):
                if (await self._read(dialogue, servo, dynamixel.HARDWARE_ERROR, 1))[0]:
                    await self._reboot(dialogue, servo)
        finally:
            self._is_rebooting = False

    async def _reboot(self, dialogue: Dialogue[Message], servo: int) -> None:
        dialogue.post(dynamixel.packet(servo, dynamixel.REBOOT))
        await asyncio.sleep(_BOOTS_S)
        ping = dynamixel.packet(servo, dynamixel.PING)
        await dialogue.ask(ping, _from(servo), timeout_s=_ANSWER_S, tries=_BOOT_TRIES, despite_stops=True)
        error, _ = await self._read(dialogue, servo, dynamixel.HARDWARE_ERROR, 1)
        if error:
            raise DeviceError(self.name, _HARDWARE, f"servo {servo}, rebooted: {dynamixel.hardware_error(error)}")

    async def _enable(self, dialogue: Dialogue[Message]) -> None:
        self._is_enabling = True
        try:
            for servo in (self._pan, self._tilt):
                # 0 first: one that ran out refuses all goals until then. Torque last: nothing holds unwatched.
                await self._write(dialogue, servo, dynamixel.BUS_WATCHDOG, 0, 1)
                await self._write(dialogue, servo, dynamixel.BUS_WATCHDOG, self._watchdog, 1)
                await self._write(dialogue, servo, dynamixel.TORQUE_ENABLE, 1, 1)
        finally:
            self._is_enabling = False

    async def _attend(self, dialogue: Dialogue[Message]) -> NoReturn:
        """Feed the bus watchdog, and see that the servos are there."""
        while True:
            for servo in (self._pan, self._tilt):
                if not self._is_rebooting:
                    await self._read(dialogue, servo, dynamixel.PRESENT_POSITION, 4)
                if not self._may_move and not self._is_rebooting:
                    await self._see_let_go(dialogue, servo)
            await dialogue.until_idle(_IDLE_POLL_S)

    async def _see_let_go(self, dialogue: Dialogue[Message], servo: int) -> None:
        """Say the stop again to a servo that holds though nobody armed it: nothing acknowledges a stop."""
        holds, _ = await self._read(dialogue, servo, dynamixel.TORQUE_ENABLE, 1)
        if holds and not self._may_move and not self._is_enabling:
            dialogue.post(self.STOP)

    async def _come_to_rest(self, dialogue: Dialogue[Message]) -> None:
        """Nothing acknowledges what is told to both servos at once: say it until both let go and rest."""
        while True:
            goes_on = False
            for servo in (self._pan, self._tilt):
                for register in (dynamixel.TORQUE_ENABLE, dynamixel.MOVING):
                    # Both registers: a servo that let go may still coast, and one that stands may still hold.
                    goes_on |= bool((await self._read(dialogue, servo, register, 1))[0])
            if not goes_on:
                return
            dialogue.post(self.STOP)

    def _report(self, heard: Heard[Message]) -> None:
        """Let go by echoes and late answers."""

    async def _read(self, dialogue: Dialogue[Message], servo: int, register: int, size: int) -> tuple[int, int]:
        """Return a register and when it came."""
        heard = await dialogue.ask(
            dynamixel.read(servo, register, size), _from(servo), timeout_s=_ANSWER_S, tries=_TRIES, despite_stops=True
        )
        parameters = self._accepted(heard.message)
        if len(parameters) != size:
            raise RemoteProtocolError(f"{self.name}: expected {size} bytes of register {register}, got {parameters!r}")
        # Only positions take four bytes, and only they are signed.
        return int.from_bytes(parameters, "little", signed=size == 4), heard.time_ns

    async def _write(self, dialogue: Dialogue[Message], servo: int, register: int, value: int, size: int) -> None:
        data = dynamixel.write(servo, register, value, size)
        self._accepted((await dialogue.ask(data, _from(servo), timeout_s=_ANSWER_S, tries=_TRIES)).message)

    def _accepted(self, message: Message) -> bytes:
        assert isinstance(message, ServoStatus)
        if message.error & ALERT and not self._is_rebooting and _HARDWARE not in self._health.faults:
            self._latch(_HARDWARE, f"servo {message.servo} overloaded, overheated or undervolted: clear reboots it")
        if message.error & ~ALERT:
            raise DeviceError(self.name, f"error_{message.error & ~ALERT}", f"servo {message.servo} refused")
        return message.parameters


def _from(servo: int) -> Callable[[Message], bool]:
    def test(message: Message) -> bool:
        return isinstance(message, ServoStatus) and message.servo == servo

    return test


def _counts(angle_rad: float) -> int:
    return round(angle_rad * _COUNTS_PER_RAD) + _CENTRE


def _rad(counts: int) -> float:
    return (counts - _CENTRE) / _COUNTS_PER_RAD
