"""Two emulated Dynamixel servos on one bus, on top of a head's physics."""

import math
import struct
from collections.abc import Iterator

from robotd.hardware.wire import dynamixel
from robotd.hardware.wire.dynamixel import BROADCAST, STATUS, DynamixelWire, Instruction
from robotd.sim.emulators.speaking import Speaking
from robotd.sim.physics.plant import HeadPlant

_COUNTS_PER_RAD = 4096 / math.tau
_CENTRE = 2048
_MODEL = struct.pack("<HB", 1060, 45)
_BOOTS_US = 250_000
"""The quarter of a second for which a real one is silent."""
_UNKNOWN_INSTRUCTION, _RANGE, _ACCESS = 2, 4, 7


class DynamixelEmulator(Speaking):
    """Ids ``pan`` and ``tilt``; the registers that a pan/tilt head needs."""

    def __init__(self, plant: HeadPlant, pan: int = 1, tilt: int = 2) -> None:
        super().__init__()
        self._plant = plant
        self._servos = (pan, tilt)
        self._wire = DynamixelWire()
        self._goals = {pan: _CENTRE, tilt: _CENTRE}
        self._torque = {pan: 0, tilt: 0}
        self._watchdog = {pan: 0, tilt: 0}
        self._is_expired = {pan: False, tilt: False}
        self._hardware_error = {pan: 0, tilt: 0}
        self._boots_until_us = {pan: 0, tilt: 0}
        self._heard_us = 0
        self._now_us = 0

    def shut_down(self, servo: int, hardware_error: int) -> None:
        """Let go of the axis, as a servo does that is overloaded; only a reboot ends that."""
        self._hardware_error[servo] = hardware_error
        self._torque[servo] = 0
        self._plant.halt()

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        self.advance(now_us)
        for message in self._wire.feed(data):
            self._heard_us = now_us
            if isinstance(message, Instruction):
                self._obey(message)

    def advance(self, now_us: int) -> None:
        """Let time pass; a bus that fell silent stops the servos whose watchdog is on."""
        self._now_us = max(self._now_us, now_us)
        self._plant.advance(self._now_us)
        for servo, unit in self._watchdog.items():
            if unit and not self._is_expired[servo] and self._now_us >= self._runs_out_us(unit):
                self._is_expired[servo] = True
                self._plant.halt()

    @property
    def next_event_us(self) -> int | None:
        """When a watchdog runs out."""
        return min(self._due_us(), default=None)

    def _due_us(self) -> Iterator[int]:
        for servo, unit in self._watchdog.items():
            if unit and not self._is_expired[servo]:
                yield self._runs_out_us(unit)

    def _runs_out_us(self, unit: int) -> int:
        return self._heard_us + unit * dynamixel.BUS_WATCHDOG_MS * 1000

    def _obey(self, order: Instruction) -> None:
        if order.servo == BROADCAST:
            if order.instruction == dynamixel.SYNC_WRITE:
                register, size = struct.unpack_from("<HH", order.parameters)
                for at in range(4, len(order.parameters), size + 1):
                    servo = order.parameters[at]
                    if servo in self._servos:
                        self._write(servo, register, order.parameters[at + 1 : at + 1 + size])
            return
        # A servo that boots, or is not there, is silent: nothing tells a host which of the two it is.
        if order.servo not in self._servos or self._now_us < self._boots_until_us[order.servo]:
            return
        if order.instruction == dynamixel.PING:
            self._answer(order.servo, 0, _MODEL)
        elif order.instruction == dynamixel.READ:
            self._read(order.servo, *struct.unpack("<HH", order.parameters))
        elif order.instruction == dynamixel.WRITE:
            register = struct.unpack_from("<H", order.parameters)[0]
            self._answer(order.servo, self._write(order.servo, register, order.parameters[2:]))
        elif order.instruction == dynamixel.REBOOT:
            self._answer(order.servo, 0)
            self._boots_until_us[order.servo] = self._now_us + _BOOTS_US
            self._hardware_error[order.servo] = self._torque[order.servo] = self._watchdog[order.servo] = 0
            self._is_expired[order.servo] = False
            self._plant.halt()
        else:
            self._answer(order.servo, _UNKNOWN_INSTRUCTION)

    def _read(self, servo: int, register: int, size: int) -> None:
        values = {
            dynamixel.TORQUE_ENABLE: self._torque[servo],
            dynamixel.HARDWARE_ERROR: self._hardware_error[servo],
            # -1 is how a servo says that its watchdog ran out.
            dynamixel.BUS_WATCHDOG: -1 if self._is_expired[servo] else self._watchdog[servo],
            dynamixel.GOAL_POSITION: self._goals[servo],
            dynamixel.MOVING: int(self._plant.arrives_us is not None),
            dynamixel.PRESENT_POSITION: self._at(servo),
        }
        self._answer(servo, 0, values.get(register, 0).to_bytes(size, "little", signed=True))

    def _write(self, servo: int, register: int, data: bytes) -> int:
        """Write a register; return the error."""
        value = int.from_bytes(data, "little", signed=len(data) == 4)
        if register == dynamixel.BUS_WATCHDOG:
            self._watchdog[servo] = value
            self._is_expired[servo] = False
        elif register == dynamixel.TORQUE_ENABLE:
            # A servo that shut down takes no torque until it was rebooted.
            if value and self._hardware_error[servo]:
                return _ACCESS
            self._torque[servo] = value
            if not value:
                self._plant.halt()
        elif register == dynamixel.GOAL_POSITION:
            if self._is_expired[servo]:
                return _ACCESS
            if not 0 <= value <= 4095:
                return _RANGE
            self._goals[servo] = value
            if self._torque[servo]:
                self._plant.aim(*(self._rad(self._goals[one]) for one in self._servos))
        return 0

    def _at(self, servo: int) -> int:
        angle_rad = self._plant.angles_rad[self._servos.index(servo)]
        return round(angle_rad * _COUNTS_PER_RAD) + _CENTRE

    def _rad(self, counts: int) -> float:
        return (counts - _CENTRE) / _COUNTS_PER_RAD

    def _answer(self, servo: int, error: int, parameters: bytes = b"") -> None:
        alert = dynamixel.ALERT if self._hardware_error[servo] else 0
        self._said += dynamixel.packet(servo, STATUS, bytes((error | alert,)) + parameters)
