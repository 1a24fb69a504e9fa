"""An emulated Dimetix distance sensor: its ASCII commands on top of a laser's physics."""

import re

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.sim.emulators.speaking import Speaking
from robotd.sim.physics.plant import LaserPlant, ShotAnswer

_COMMAND = re.compile(rb"s(\d)([a-z]+)")
_TEMPERATURE_TENTH_C = 253
_ERRORS = {
    ShotStatus.OVER_RANGE: 255,
    ShotStatus.TOO_NEAR: 254,
    ShotStatus.WEAK: 255,
    ShotStatus.SATURATED: 256,
    ShotStatus.AMBIENT: 257,
}


class DimetixEmulator(Speaking):
    """Answers as device ``device``; a new command cancels a measurement under way."""

    def __init__(self, plant: LaserPlant, device: int = 0) -> None:
        super().__init__()
        self._plant = plant
        self._device = device
        self._typed = bytearray()
        self._say("?")
        self._pending: tuple[int, ShotAnswer] | None = None
        self._points = False

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        self.advance(now_us)
        self._typed += data
        while (end := self._typed.find(b"\n")) >= 0:
            typed = bytes(self._typed[:end]).strip()
            del self._typed[: end + 1]
            self._obey(typed, now_us)

    def advance(self, now_us: int) -> None:
        """Let time pass."""
        if self._pending is not None and self._pending[0] <= now_us:
            answer, self._pending = self._pending[1], None
            self._plant.switch(on=self._points)
            if answer.status is ShotStatus.OK:
                self._say_distance(round(answer.range_m * 10_000))
            else:
                self._say(f"@E{_ERRORS.get(answer.status, 203)}")

    @property
    def next_event_us(self) -> int | None:
        """When a measurement is done."""
        return None if self._pending is None else self._pending[0]

    def _obey(self, typed: bytes, now_us: int) -> None:
        found = _COMMAND.fullmatch(typed)
        if found is None:
            if typed:
                self._say("@E203")
        # Up to ten share a line, so what is meant for another is passed over without a word.
        elif int(found[1]) == self._device:
            self._do(found[2].decode(), now_us)

    def _do(self, letters: str, now_us: int) -> None:
        self._pending = None
        if letters == "g":
            self._plant.switch(on=True)
            answer = self._plant.shoot(now_us)
            self._pending = (now_us + answer.takes_us, answer)
        elif letters in {"o", "c"}:
            self._points = letters == "o"
            self._plant.switch(on=self._points)
            self._say("?")
        elif letters == "t":
            self._say(f"t{_TEMPERATURE_TENTH_C:+09d}")
        else:
            self._say("@E203")

    def _say_distance(self, tenth_mm: int) -> None:
        self._say(f"g{tenth_mm:+09d}")

    def _say(self, text: str) -> None:
        self._said += f"g{self._device}{text}\r\n".encode()
