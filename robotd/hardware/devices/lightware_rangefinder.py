"""What the two dialects of a LightWare LW20 or SF20 share: it measures all the time, and is asked for the newest.

It is told to measure 388 times a second, so what it answers is not more than a few milliseconds old, and the head has
stood still for longer than that when it says so. A signal that is lost comes as a negative distance, or as a flat one
beyond all that it can measure (130, 160, 230 and 250 m were seen): nothing came back, be the room empty or black there,
so it says nothing about the room.
"""

import asyncio
from abc import abstractmethod
from typing import ClassVar, NoReturn, TypeVar

from robotd.core.clock import now_ns
from robotd.core.errors import DeviceError, LinkTimeout, RemoteProtocolError
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.instrument import Instrument
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.settings import RangefinderSettings
from robotd.hardware.devices.vendor_device import VendorDevice
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue, Heard, Wire
from robotd.hardware.wire.lw20 import PRODUCTS

_REACH_M = 100.0
M = TypeVar("M")

ANSWER_S = 0.2
TRIES = 3
_LOST_SIGNAL_M = frozenset({130.0, 160.0, 230.0, 250.0})
"""All beyond its reach: not named here, a lost signal would count as a broken device instead of a weak reading."""
_IDLE_POLL_S = 1.0


class LightwareRangefinder(VendorDevice[M]):
    """Implements :class:`robotd.hardware.devices.rangefinder.Rangefinder`, but for the bytes."""

    NAME: ClassVar[str] = "rangefinder"

    def __init__(self, wire: Wire[M], settings: RangefinderSettings, wiring: Wiring) -> None:
        """Make the device; its bias is applied to every range."""
        super().__init__(wire, wiring)
        self._instrument = Instrument(settings, _REACH_M)
        self._shooting = asyncio.Lock()

    async def switch_laser(self, *, on: bool) -> None:
        """Switch the light; same errors as :meth:`arm`."""
        await self._fire(self._talk(), on=on)

    async def shoot(self, *, timeout_s: float) -> Shot:
        """Take one reading; TransportError if the device is absent, any other failure is a result."""
        dialogue = self._talk()
        async with self._shooting:
            try:
                # Shared out to the tries, so that all of them together take no longer than a shot may.
                return await self._newest(dialogue, min(ANSWER_S, timeout_s / TRIES))
            except LinkTimeout:
                return Shot(now_ns(), ReadingStatus.TIMEOUT, None, None)
            except DeviceError:
                return Shot(now_ns(), ReadingStatus.DEVICE_ERROR, None, None)

    async def _attend(self, dialogue: Dialogue[M]) -> NoReturn:
        """It speaks only when asked, so that it is still there must be asked: for its name."""
        while True:
            await dialogue.until_idle(_IDLE_POLL_S)
            await self._product(dialogue)

    def _report(self, heard: Heard[M]) -> None:
        """Let go by answers to stops, and what comes late."""

    async def _check_product(self, dialogue: Dialogue[M]) -> None:
        product = await self._product(dialogue)
        if not product.startswith(PRODUCTS):
            raise RemoteProtocolError(f"{self.name}: expected one of {', '.join(PRODUCTS)}, got {product!r}")

    def _shot(self, time_ns: int, distance_m: float | None, strength: int | None) -> Shot:
        if distance_m is None:
            return Shot(time_ns, ReadingStatus.DEVICE_ERROR, None, strength)
        if distance_m <= 0.0 or distance_m in _LOST_SIGNAL_M:
            return Shot(time_ns, ReadingStatus.WEAK, None, strength)
        return self._instrument.shot(time_ns, distance_m, strength)

    def _unlikely(self) -> int:
        return self._instrument.implausible

    @abstractmethod
    async def _product(self, dialogue: Dialogue[M]) -> str:
        """Ask for its name, whatever was stopped; LinkTimeout."""

    @abstractmethod
    async def _fire(self, dialogue: Dialogue[M], *, on: bool) -> None:
        """Switch the light."""

    @abstractmethod
    async def _newest(self, dialogue: Dialogue[M], timeout_s: float) -> Shot:
        """Ask for the newest measurement; a try may take ``timeout_s``."""
