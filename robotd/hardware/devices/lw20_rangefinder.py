"""A LightWare LW20 or SF20 on its ASCII line."""

from collections.abc import Callable

from robotd.hardware.devices.lightware_rangefinder import ANSWER_S, TRIES, LightwareRangefinder
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.settings import RangefinderSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue
from robotd.hardware.wire import lw20
from robotd.hardware.wire.lw20 import Lw20Answer, Lw20Wire

_RAW = 1


class Lw20Rangefinder(LightwareRangefinder[Lw20Answer]):
    """Implements :class:`robotd.hardware.devices.rangefinder.Rangefinder`."""

    STOP = b"\r\n" + lw20.LASER_OFF
    """The line end ends a command that was cut in half."""

    def __init__(self, settings: RangefinderSettings, wiring: Wiring) -> None:
        """Make the device; its bias is applied to every range."""
        super().__init__(Lw20Wire(), settings, wiring)

    async def _greet(self, dialogue: Dialogue[Lw20Answer]) -> None:
        # Before the stop, which would be lost as the message that only chooses the bus.
        dialogue.post(lw20.WAKE)
        dialogue.stop_now(self.STOP)
        await self._check_product(dialogue)
        await self._fire(dialogue, on=False)
        dialogue.post(lw20.FASTEST)

    async def _product(self, dialogue: Dialogue[Lw20Answer]) -> str:
        heard = await dialogue.ask(lw20.PRODUCT, _named("p"), timeout_s=ANSWER_S, tries=TRIES, despite_stops=True)
        return heard.message.text

    async def _fire(self, dialogue: Dialogue[Lw20Answer], *, on: bool) -> None:
        await dialogue.ask(lw20.LASER_ON if on else lw20.LASER_OFF, _named("lf"), timeout_s=ANSWER_S, tries=TRIES)

    async def _newest(self, dialogue: Dialogue[Lw20Answer], timeout_s: float) -> Shot:
        heard = await dialogue.ask(
            lw20.FIRST_RETURN_RAW, _named("ldf", _RAW), timeout_s=timeout_s, tries=TRIES, late_s=0.0
        )
        return self._shot(heard.time_ns, heard.message.number, None)


def _named(name: str, index: int | None = None) -> Callable[[Lw20Answer], bool]:
    return lambda answer: answer.name == name and index in {None, answer.index}
