"""A LightWare LW20 or SF20 on its binary line, LWNX."""

from collections.abc import Callable

from robotd.hardware.devices.lightware_rangefinder import ANSWER_S, TRIES, LightwareRangefinder
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.settings import RangefinderSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue
from robotd.hardware.wire import lwnx
from robotd.hardware.wire.lwnx import LwnxWire, Packet

_CM_PER_M = 100


class LwnxRangefinder(LightwareRangefinder[Packet]):
    """Implements :class:`robotd.hardware.devices.rangefinder.Rangefinder`."""

    STOP = lwnx.write(lwnx.LASER_FIRING, 0, 1)

    def __init__(self, settings: RangefinderSettings, wiring: Wiring) -> None:
        """Make the device; its bias is applied to every range."""
        super().__init__(LwnxWire(), settings, wiring)

    async def _greet(self, dialogue: Dialogue[Packet]) -> None:
        dialogue.stop_now(self.STOP)
        await self._check_product(dialogue)  # asked until answered, for this also chooses the binary dialect
        await self._fire(dialogue, on=False)
        await self._write(dialogue, lwnx.STREAM, 0, 4)  # each reading is asked for, when the head rests
        await self._write(dialogue, lwnx.RATE, lwnx.RATE_MAX, 1)
        await self._write(dialogue, lwnx.DISTANCE_OUTPUT, lwnx.RAW_AND_STRENGTH, 4)

    async def _product(self, dialogue: Dialogue[Packet]) -> str:
        request = lwnx.read(lwnx.NAME)
        heard = await dialogue.ask(request, _numbered(lwnx.NAME), timeout_s=ANSWER_S, tries=TRIES, despite_stops=True)
        return heard.message.text

    async def _fire(self, dialogue: Dialogue[Packet], *, on: bool) -> None:
        await self._write(dialogue, lwnx.LASER_FIRING, int(on), 1)

    async def _newest(self, dialogue: Dialogue[Packet], timeout_s: float) -> Shot:
        request = lwnx.read(lwnx.DISTANCE)
        heard = await dialogue.ask(request, _numbered(lwnx.DISTANCE), timeout_s=timeout_s, tries=TRIES, late_s=0.0)
        if (reading := heard.message.reading) is None:
            return self._shot(heard.time_ns, None, None)
        distance_cm, strength = reading
        return self._shot(heard.time_ns, distance_cm / _CM_PER_M, strength)

    async def _write(self, dialogue: Dialogue[Packet], number: int, value: int, size: int) -> None:
        await dialogue.ask(lwnx.write(number, value, size), _numbered(number), timeout_s=ANSWER_S, tries=TRIES)


def _numbered(number: int) -> Callable[[Packet], bool]:
    return lambda packet: packet.number == number
