"""An emulated LightWare LW20 on its binary line: it measures all the time, and answers with the newest."""

import struct

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.hardware.wire.lwnx import DISTANCE, LASER_FIRING, NAME, LwnxWire, Packet, encoded
from robotd.sim.emulators.speaking import SpeakingWhenAsked
from robotd.sim.physics.plant import LaserPlant

_NAME = b"LW20".ljust(16, b"\0")
_LOST_CM = -100
_FULL_STRENGTH, _PERCENT = 65_535, 100


class LwnxEmulator(SpeakingWhenAsked):
    """Fires from power-up, and never answers the first message after it."""

    def __init__(self, plant: LaserPlant) -> None:
        super().__init__()
        self._plant = plant
        self._plant.switch(on=True)
        self._wire = LwnxWire()
        self._is_awake = False

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        for request in self._wire.feed(data):
            # The first message after power-up only wakes it.
            if self._is_awake:
                self._said += encoded(Packet(request.number, self._answer(request, now_us), writes=request.writes))
            self._is_awake = True

    def _answer(self, request: Packet, now_us: int) -> bytes:
        if request.number == NAME:
            return _NAME
        if request.number == DISTANCE:
            answer = self._plant.shoot(now_us)
            distance_cm = round(answer.range_m * 100) if answer.status is ShotStatus.OK else _LOST_CM
            return struct.pack("<hh", distance_cm, answer.strength * _PERCENT // _FULL_STRENGTH)
        if request.number == LASER_FIRING and request.writes:
            self._plant.switch(on=request.data == b"\1")
        return b""
