"""A Dimetix distance sensor, or an older Leica DISTO: one command, one reading or one numbered error."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, NoReturn, Self

from robotd.core.clock import now_ns
from robotd.core.errors import DeviceError, LinkTimeout, RemoteProtocolError
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.dialect_options import DimetixSettings
from robotd.hardware.devices.instrument import Instrument
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.settings import RangefinderSettings
from robotd.hardware.devices.vendor_device import VendorDevice
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue, Heard
from robotd.hardware.wire import dimetix, disto
from robotd.hardware.wire.dimetix import DimetixWire, Distance, ErrorCode, Failed, Message, Ready, Value

_TENTH_MM_PER_M = 10_000
_REACH_M, _REACH_OF_DISTO_M = 500.0, 200.0
_ANSWER_S = 1.0
_TRIES = 3
_IDLE_POLL_S = 1.0
_SIGN_OF_LIFE_S = 0.5
"""Three tries and the idle second before them: a silent device is lost within 2.8 s (docs/safety.md)."""
_MEASURES_S = 5.0
"""A dark target may take so long; then the measurement is cleared."""
_LINE_END = b"\r\n"
"""Comes before a stop, to end a command that was cut in half."""
_STATUS: dict[int, ReadingStatus] = {
    ErrorCode.BAD_SIGNAL: ReadingStatus.WEAK,
    ErrorCode.TOO_WEAK: ReadingStatus.WEAK,
    ErrorCode.TOO_STRONG: ReadingStatus.SATURATED,
    ErrorCode.AMBIENT_LIGHT: ReadingStatus.AMBIENT,
}


@dataclass(frozen=True, slots=True)
class _Tongue:
    """What differs between the two dialects."""

    reach_m: float
    parse: Callable[[str], Message | None]
    device: int
    off: bytes
    """Clears a measurement under way, where that can be told, and switches the light off."""
    light_on: bytes
    measure: bytes
    temperature: bytes

    @classmethod
    def of(cls, settings: RangefinderSettings) -> Self:
        if not isinstance(settings, DimetixSettings):
            return cls(_REACH_OF_DISTO_M, disto.parsed, 0, *map(disto.command, "pogt"))
        device = settings.device_id
        return cls(_REACH_M, dimetix.parsed, device, *(dimetix.command(device, letter) for letter in "cogt"))


class DimetixRangefinder(VendorDevice[Message]):
    """Implements :class:`robotd.hardware.devices.rangefinder.Rangefinder`."""

    NAME: ClassVar[str] = "rangefinder"

    def __init__(self, settings: RangefinderSettings, wiring: Wiring) -> None:
        """Make the device; its bias is applied to every range."""
        self._tongue = _Tongue.of(settings)
        super().__init__(DimetixWire(self._tongue.parse), wiring)
        self.STOP = _LINE_END + self._tongue.off
        self._instrument = Instrument(settings, self._tongue.reach_m)
        self._shooting = asyncio.Lock()

    async def switch_laser(self, *, on: bool) -> None:
        """Switch the light; same errors as :meth:`arm`."""
        await self._order(self._tongue.light_on if on else self._tongue.off)

    async def shoot(self, *, timeout_s: float) -> Shot:
        """Take one reading; TransportError if the device is absent, any other failure is a result."""
        dialogue = self._talk()
        patience_s = min(timeout_s, _MEASURES_S)
        # Around the clearing, too, which must not end somebody else's measurement.
        async with self._shooting:
            try:
                # One try: a second command would cancel the measurement under way, and begin it again.
                heard = await dialogue.ask(self._tongue.measure, self._is(Distance), timeout_s=patience_s)
            except LinkTimeout:
                dialogue.post(self._tongue.off)  # or the next command waits behind a dark target
                return Shot(now_ns(), ReadingStatus.TIMEOUT, None, None)
            except DeviceError:
                return Shot(now_ns(), ReadingStatus.DEVICE_ERROR, None, None)
        message = heard.message
        if isinstance(message, Distance):
            return self._instrument.shot(heard.time_ns, message.tenth_mm / _TENTH_MM_PER_M, None)
        code = message.code if isinstance(message, Failed) else 0
        return Shot(heard.time_ns, _STATUS.get(code, ReadingStatus.DEVICE_ERROR), None, None)

    async def _greet(self, dialogue: Dialogue[Message]) -> None:
        dialogue.stop_now(self.STOP)
        clear = await dialogue.ask(self._tongue.off, self._is(Ready), timeout_s=_ANSWER_S, tries=_TRIES)
        if isinstance(clear.message, Failed):
            raise RemoteProtocolError(f"{self.name}: refused to clear: error {clear.message.code}")

    async def _attend(self, dialogue: Dialogue[Message]) -> NoReturn:
        """It speaks only when asked, so that it is still there must be asked: for its temperature."""
        while True:
            await dialogue.until_idle(_IDLE_POLL_S)
            await dialogue.ask(
                self._tongue.temperature, self._is(Value), timeout_s=_SIGN_OF_LIFE_S, tries=_TRIES, despite_stops=True
            )

    def _report(self, heard: Heard[Message]) -> None:
        """Let go by what comes late: the answer to a measurement that was given up."""

    def _unlikely(self) -> int:
        return self._instrument.implausible

    async def _order(self, data: bytes) -> None:
        answer = (await self._talk().ask(data, self._is(Ready), timeout_s=_ANSWER_S, tries=_TRIES)).message
        if isinstance(answer, Failed):
            raise DeviceError(self.name, f"error_{answer.code}", f"refused {data!r}")

    def _is(self, kind: type) -> Callable[[Message], bool]:
        """Return a test for answers of this device: the one expected, or an error."""
        return lambda message: message.device == self._tongue.device and isinstance(message, (kind, Failed))
