"""An emulated rFLEX base on top of a synchro-drive's physics: when its host is gone it drives on, as the real one."""

import struct

from robotd.hardware.wire.rflex import (
    BRAKE_RELEASE,
    BRAKE_SET,
    DIO,
    MOTION,
    STATUS,
    SYSTEM,
    OtherFrame,
    RflexWire,
    frame,
)
from robotd.sim.emulators.speaking import Speaking
from robotd.sim.physics.plant import BumperWatch, DrivePlant

COUNTS_PER_M = 101_230.0
COUNTS_PER_RAD = 35_343.888
_PLANT_COUNTS_PER_M = 27_300.0
_PLANT_COUNTS_PER_RAD = 4_096.0
_SPACING_US = 10_000
_ESCAPE = 0x1B
_PANELS = 14


class RflexEmulator(Speaking):
    """Like the real one it drops orders that come in bursts, and speeds that its firmware loses."""

    def __init__(self, plant: DrivePlant) -> None:
        super().__init__()
        self._plant = plant
        self._bumper_watch = BumperWatch(plant)
        self._wire = RflexWire()
        self._speeds = [0.0, 0.0]
        self._braked = True
        self._sender = 0
        self._now_us = 0
        self._heard_us = -_SPACING_US
        self._period_us = 0
        self._report_us: int | None = None
        self._reports_switches = False
        self._bumpers = 0

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        self.advance(now_us)
        for message in self._wire.feed(data):
            # Since the last one heard, dropped or not: of a burst nothing but its first is obeyed.
            is_burst, self._heard_us = now_us - self._heard_us < _SPACING_US, now_us
            if isinstance(message, OtherFrame) and not is_burst:
                self._obey(message)

    def advance(self, now_us: int) -> None:
        """Let time pass; what falls due on the way happens at its own time."""
        while self._report_us is not None and self._report_us <= now_us:
            self._pass(self._report_us)
            self._report_us += self._period_us
            self._report()
        self._pass(now_us)

    @property
    def next_event_us(self) -> int | None:
        """When the next report is due, or a moving base looks at its bumpers."""
        due_us = (self._report_us, self._bumper_watch.due_us)
        return min((at for at in due_us if at is not None), default=None)

    def _pass(self, to_us: int) -> None:
        self._now_us = max(self._now_us, to_us)
        self._plant.advance(self._now_us)
        self._bumper_watch.looked(self._now_us)
        bumpers = self._plant.bumpers
        if bumpers != self._bumpers and self._reports_switches:
            for panel in range(_PANELS):
                pressed = 3 if bumpers & 1 << round(panel * 16 / _PANELS) else 0
                self._say(DIO, 1, struct.pack(">IBH", self._now_us & 0xFFFFFFFF, 0x40 + panel, pressed))
        self._bumpers = bumpers

    def _obey(self, order: OtherFrame) -> None:
        what = frame(order.port, order.opcode, order.data)
        if what == STATUS:
            volts = round(self._plant.battery_mv / 10)
            self._say(SYSTEM, 1, struct.pack(">IIB", self._now_us & 0xFFFFFFFF, volts, self._braked))
        elif what in {BRAKE_RELEASE, BRAKE_SET}:
            self._braked = what == BRAKE_SET
        elif (order.port, order.opcode) == (MOTION, 34):
            self._period_us, axes = struct.unpack(">II", order.data)
            self._report_us = self._now_us + self._period_us if axes else None
        elif (order.port, order.opcode) == (DIO, 0):
            self._reports_switches = struct.unpack(">I", order.data)[0] > 0
        elif (order.port, order.opcode) == (MOTION, 7):
            self._run(*struct.unpack(">BIIIB", order.data))

    def _run(self, axis: int, speed: int, acceleration: int, torque: int, forwards: int) -> None:
        # Its firmware loses these, silently: the fault that safe_speed in the wire is there for.
        if _ESCAPE in {speed >> 8 & 0xFF, speed >> 24 & 0xFF}:
            return
        self._speeds[axis] = (speed if forwards else -speed) / (COUNTS_PER_RAD if axis else COUNTS_PER_M)
        self._plant.command(self._speeds[0], self._speeds[1])

    def _report(self) -> None:
        translate, rotate = self._plant.counts
        speed_mps, turn_radps = self._plant.velocity
        positions = (
            round(translate / _PLANT_COUNTS_PER_M * COUNTS_PER_M),
            round(rotate / _PLANT_COUNTS_PER_RAD * COUNTS_PER_RAD),
        )
        speeds = (round(speed_mps * COUNTS_PER_M), round(turn_radps * COUNTS_PER_RAD))
        for axis in (0, 1):
            position = (positions[axis] + 0x80000000) % 0x100000000 - 0x80000000
            now_us = self._now_us & 0xFFFFFFFF
            self._say(MOTION, 33, struct.pack(">IIBiiII", 0, now_us, axis, position, speeds[axis], 0, 0))

    def _say(self, port: int, opcode: int, data: bytes) -> None:
        self._sender = (self._sender + 1) & 0xFF
        self._said += frame(port, opcode, data, sender=self._sender)
