"""An emulated Benewake TFmini of any model: streams from power-up, and measures on a trigger once it is told to.

But for the first generation, which streams and hears nothing.
"""

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.hardware.wire.tfmini import FORMAT_CM, OUTPUT_OFF, OUTPUT_ON, RATE_0, TRIGGER, VERSION, Model, command
from robotd.sim.emulators.speaking import Speaking
from robotd.sim.physics.plant import LaserPlant, ShotAnswer

_STREAM_US = 10_000
"""A hundred readings a second, as from power-up."""
_TEMPERATURE = b"\xc8\x08"
_VERSION = b"\x08\x00\x02"
_SENTINELS = {
    ShotStatus.OVER_RANGE: (0xFFFF, 60),
    ShotStatus.WEAK: (0xFFFF, 60),
    ShotStatus.TOO_NEAR: (0, 60),
    ShotStatus.SATURATED: (0xFFFE, 0xFFFF),
}
_SENTINELS_OF = {
    Model.TFMINI: {ShotStatus.OVER_RANGE: (1200, 60), ShotStatus.WEAK: (0xFFFF, 10)},
    Model.TFMINI_S: {**_SENTINELS, ShotStatus.AMBIENT: (0xFFFC, 500)},
}
_STRENGTH_MIN, _STRENGTH_MAX = 101, 30_000
"""A good reading is never called weak, or saturated, for its strength."""


class TfminiEmulator(Speaking):
    """Its light is always on."""

    def __init__(self, plant: LaserPlant, *, model: Model = Model.TFMINI_S) -> None:
        super().__init__()
        self._plant = plant
        self._is_first = model is Model.TFMINI
        self._sentinels = _SENTINELS_OF.get(model, _SENTINELS)
        self._plant.switch(on=True)
        self._typed = bytearray()
        self._streams = True
        self._speaks = True
        self._next_us: int | None = None
        self._pending: tuple[int, ShotAnswer] | None = None

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        self.advance(now_us)
        # It understands none of these commands: a host that waits for an echo waits for ever.
        if self._is_first:
            return
        self._typed += data
        while self._typed:
            if self._typed[0] != 0x5A:
                del self._typed[:1]
                continue
            size = self._typed[1] if len(self._typed) > 1 else 4
            if len(self._typed) < size:
                return
            frame = bytes(self._typed[:size])
            if size < 4 or sum(frame[:-1]) & 0xFF != frame[-1]:
                del self._typed[:1]
                continue
            del self._typed[:size]
            self._obey(frame, now_us)

    def advance(self, now_us: int) -> None:
        """Let time pass."""
        if self._next_us is None:
            self._next_us = now_us + _STREAM_US
        while self._streams and self._next_us <= now_us:
            self._measured(self._plant.shoot(self._next_us))
            self._next_us += _STREAM_US
        if self._pending is not None and self._pending[0] <= now_us:
            self._measured(self._pending[1])
            self._pending = None

    @property
    def next_event_us(self) -> int | None:
        """When the next measurement is done."""
        streamed_us = self._next_us if self._streams and self._speaks else None
        pending_us = self._pending[0] if self._pending else None
        return min((at for at in (streamed_us, pending_us) if at is not None), default=None)

    def _obey(self, frame: bytes, now_us: int) -> None:
        if frame == TRIGGER:
            if not self._streams and self._speaks:
                answer = self._plant.shoot(now_us)
                self._pending = (now_us + answer.takes_us, answer)
            return
        if frame == VERSION:
            self._said += command(0x01, _VERSION)
            return
        if frame in {OUTPUT_OFF, OUTPUT_ON}:
            self._speaks = frame == OUTPUT_ON
        elif frame == RATE_0:
            self._streams = False
        elif frame != FORMAT_CM:
            return
        self._said += frame

    def _measured(self, answer: ShotAnswer) -> None:
        if not self._speaks:
            return
        if answer.status is ShotStatus.OK:
            # A host judges by strength first, so a good reading must not look weak or saturated.
            strength = min(max(answer.strength, _STRENGTH_MIN), _STRENGTH_MAX)
            distance = round(answer.range_m * 100)
        else:
            distance, strength = self._sentinels.get(answer.status, (0xFFFF, 0))
        frame = b"\x59\x59" + distance.to_bytes(2, "little") + strength.to_bytes(2, "little") + _TEMPERATURE
        self._said += frame + bytes((sum(frame) & 0xFF,))
