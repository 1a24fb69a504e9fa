"""A Hokuyo scanner as the rangefinder of a head that does not move.

One scan serves all directions: it is taken at the first reading after the light was switched on, and is good until the
light is switched again, which missions do whenever the robot has moved. It is asked for by ``MD``, for the maker says
that such a scan is taken after the command came, while ``GD`` gives the latest there was.
"""

import asyncio
import math
from typing import ClassVar, NoReturn

from robotd.core.clock import now_ns
from robotd.core.errors import DeviceError, LinkTimeout, RemoteProtocolError
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.gaze import Fan
from robotd.hardware.devices.instrument import Instrument
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.settings import RangefinderSettings
from robotd.hardware.devices.vendor_device import VendorDevice
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue, Heard
from robotd.hardware.wire import scip
from robotd.hardware.wire.scip import Parameters, ScipReply, ScipVerdict, ScipWire

_REACH_M = 120.0
_MM_PER_M = 1000.0
_ANSWER_S = 0.5
_TRIES = 3
_IDLE_POLL_S = 1.0
_STATUS = {
    ScipVerdict.TOO_NEAR: ReadingStatus.TOO_NEAR,
    ScipVerdict.WEAK: ReadingStatus.WEAK,
    ScipVerdict.SATURATED: ReadingStatus.SATURATED,
    ScipVerdict.UNKNOWN: ReadingStatus.WEAK,
}


class ScipRangefinder(VendorDevice[ScipReply]):
    """Implements :class:`robotd.hardware.devices.rangefinder.Rangefinder`; sets the fan of the robot's gaze."""

    NAME: ClassVar[str] = "rangefinder"
    STOP = b"\n" + scip.QUIT
    """Ends a scan and switches the light off. The line end ends a command that was cut in half."""

    def __init__(self, settings: RangefinderSettings, wiring: Wiring) -> None:
        """Make the device; its bias is applied to every range."""
        super().__init__(ScipWire(), wiring)
        self._instrument = Instrument(settings, _REACH_M)
        self._gaze = wiring.gaze
        self._parameters: Parameters | None = None
        self._scan: Heard[tuple[int, ...]] | None = None
        self._shooting = asyncio.Lock()

    async def switch_laser(self, *, on: bool) -> None:
        """Forget the last scan; the light goes on and off with each by itself."""
        self._talk()
        self._scan = None

    async def shoot(self, *, timeout_s: float) -> Shot:
        """Return the reading of the direction looked at; TransportError if the device is absent."""
        dialogue = self._talk()
        async with self._shooting:
            try:
                if self._scan is None:
                    self._scan = await self._scanned(dialogue, timeout_s)
                return self._shot(self._scan)
            except LinkTimeout:
                return Shot(now_ns(), ReadingStatus.TIMEOUT, None, None)
            except DeviceError:
                return Shot(now_ns(), ReadingStatus.DEVICE_ERROR, None, None)

    def stop_now(self) -> None:
        """Put the preformatted stop on the wire, and forget the last scan; see :meth:`VendorDevice.stop_now`."""
        self._scan = None
        super().stop_now()

    async def _scanned(self, dialogue: Dialogue[ScipReply], timeout_s: float) -> Heard[tuple[int, ...]]:
        known = self._known()
        order = scip.one_scan(known.first_step, known.last_step)
        heard = await dialogue.ask(order, _is_scan_or_refusal, timeout_s=timeout_s)
        distances_mm = heard.message.distances_mm
        if heard.message.status != scip.DATA or distances_mm is None:
            raise DeviceError(self.name, f"status_{heard.message.status}", "no scan")
        if len(distances_mm) != known.last_step - known.first_step + 1:
            raise DeviceError(self.name, "cut", f"a scan of {len(distances_mm)} distances")
        return Heard(distances_mm, heard.time_ns)

    def _shot(self, scan: Heard[tuple[int, ...]]) -> Shot:
        distance_mm = scan.message[self._gaze.index]
        known = self._known()
        verdict, reach_m = known.verdict(distance_mm), known.range_max_mm / _MM_PER_M
        if verdict is None or distance_mm > known.range_max_mm:
            return self._instrument.shot(scan.time_ns, distance_mm / _MM_PER_M, None, reach_m=reach_m)
        if verdict is ScipVerdict.NOTHING:
            return self._instrument.nothing_within(scan.time_ns, reach_m, None)
        return Shot(scan.time_ns, _STATUS[verdict], None, None)

    def _unlikely(self) -> int:
        return self._instrument.implausible

    async def _greet(self, dialogue: Dialogue[ScipReply]) -> None:
        self._scan = None
        dialogue.stop_now(self.STOP)
        dialogue.post(scip.USE_SCIP2)  # older ones begin in SCIP 1.1; others do not know it, and say so
        reply = (await self._described(dialogue)).message
        parameters = Parameters.of(reply)
        if parameters is None:
            raise RemoteProtocolError(f"{self.name}: expected the parameters of a scanner, got {reply}")
        self._parameters = parameters
        step_rad = math.tau / parameters.steps_per_turn
        first_rad = (parameters.first_step - parameters.front_step) * step_rad
        self._gaze.index = 0  # before the fan: the old index may lie outside the new one
        self._gaze.fan = Fan(first_rad, step_rad, parameters.last_step - parameters.first_step + 1)

    async def _attend(self, dialogue: Dialogue[ScipReply]) -> NoReturn:
        """It speaks only when asked, so that it is still there must be asked."""
        while True:
            await dialogue.until_idle(_IDLE_POLL_S)
            await self._described(dialogue)

    def _report(self, heard: Heard[ScipReply]) -> None:
        """Let go by that a scan was begun, and answers to stops."""

    async def _described(self, dialogue: Dialogue[ScipReply]) -> Heard[ScipReply]:
        return await dialogue.ask(
            scip.PARAMETERS,
            lambda reply: reply.command == "PP" and reply.status == scip.OK,
            timeout_s=_ANSWER_S,
            tries=_TRIES,
            despite_stops=True,
        )

    def _known(self) -> Parameters:
        if self._parameters is None:
            raise DeviceError(self.name, "unknown", "it was never greeted")
        return self._parameters


def _is_scan_or_refusal(reply: ScipReply) -> bool:
    # OK only says that the command was understood: the scan comes in a second block, with a status of its own.
    return reply.command.startswith("MD") and reply.status != scip.OK
