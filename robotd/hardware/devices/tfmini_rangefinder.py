"""A Benewake TFmini and its kin in trigger mode: one command, one reading.

From power-up they stream a hundred readings a second; the stream is switched off and each reading asked for, so that it
was taken when the head stood still. Their light cannot be switched off, only their output.

A TFmini of the first generation answers no command. It is known by streaming on and on, and its stream is read: of what
comes after a reading was asked for the first frames are let go, for they were measured before.
"""

import asyncio
from typing import ClassVar, NoReturn

from robotd.core.broadcast import Broadcast
from robotd.core.clock import now_ns
from robotd.core.errors import DeviceError, LinkTimeout, RemoteProtocolError
from robotd.core.reading import ReadingStatus
from robotd.core.silence import within
from robotd.hardware.devices.dialect_options import TfminiSettings
from robotd.hardware.devices.instrument import Instrument
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.vendor_device import VendorDevice
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue, Heard
from robotd.hardware.wire.tfmini import (
    FIRST_STANDARD,
    FORMAT_CM,
    OUTPUT_OFF,
    OUTPUT_ON,
    RATE_0,
    TRIGGER,
    VERSION,
    VERSION_NUMBER,
    Data,
    Message,
    Model,
    TfminiReply,
    TfminiVerdict,
    TfminiWire,
)

_CM_PER_M = 100
_REACH_M = {Model.TFMINI: 15.0, Model.TFMINI_S: 15.0, Model.TFMINI_PLUS: 15.0, Model.TF_LUNA: 10.0}
"""A quarter beyond the maker's figure: they do read so far on bright walls."""
_ANSWER_S = 0.3
_TRIES = 3
_MEASURES_S = 0.1
"""How long a trigger may stay without its reading; then it is sent once more."""
_TRIGGERS = 2
_STREAMS_S = 0.3
"""Within this a stream of a hundred a second has come by."""
_STALE = 2
"""Frames of a stream that may have been measured before they were asked for: the one under way, and one in a buffer."""
_IDLE_POLL_S = 1.0
_STATUS = {
    TfminiVerdict.WEAK: ReadingStatus.WEAK,
    TfminiVerdict.SATURATED: ReadingStatus.SATURATED,
    TfminiVerdict.AMBIENT: ReadingStatus.AMBIENT,
}


class TfminiRangefinder(VendorDevice[Message]):
    """Implements :class:`robotd.hardware.devices.rangefinder.Rangefinder`."""

    NAME: ClassVar[str] = "rangefinder"
    STOP = RATE_0

    def __init__(self, settings: TfminiSettings, wiring: Wiring) -> None:
        """Make the device: its dialect names the model; its bias is applied to every range."""
        super().__init__(TfminiWire(), wiring)
        self._model = Model(settings.dialect)
        self._silence_s = settings.silence_s
        self._instrument = Instrument(settings, _REACH_M[self._model])
        self._streamed: Broadcast[Heard[Data]] = Broadcast()
        self._is_first = False
        """Whether it is of the first generation."""
        self._shooting = asyncio.Lock()

    async def switch_laser(self, *, on: bool) -> None:
        """Do nothing but see that the device is there: its light cannot be switched."""
        self._talk()

    async def shoot(self, *, timeout_s: float) -> Shot:
        """Take one reading; TransportError if the device is absent, any other failure is a result."""
        dialogue = self._talk()
        # One at a time: a frame does not say which trigger it answers.
        async with self._shooting:
            try:
                heard = await (self._fresh(timeout_s) if self._is_first else self._triggered(dialogue, timeout_s))
            except LinkTimeout:
                return Shot(now_ns(), ReadingStatus.TIMEOUT, None, None)
            except DeviceError:
                return Shot(now_ns(), ReadingStatus.DEVICE_ERROR, None, None)
        data = heard.message
        verdict = data.verdict(self._model)
        distance_m = data.distance / _CM_PER_M
        if verdict is TfminiVerdict.OUT_OF_RANGE:
            return self._instrument.nothing_within(heard.time_ns, distance_m, data.strength)
        if verdict is not TfminiVerdict.OK:
            return Shot(heard.time_ns, _STATUS[verdict], None, data.strength)
        return self._instrument.shot(heard.time_ns, distance_m, data.strength)

    def _unlikely(self) -> int:
        return self._instrument.implausible

    async def _triggered(self, dialogue: Dialogue[Message], timeout_s: float) -> Heard[Data]:
        # All tries within the time that the caller has.
        heard = await dialogue.ask(
            TRIGGER, _is_data, timeout_s=min(_MEASURES_S, timeout_s / _TRIGGERS), tries=_TRIGGERS, late_s=0.0
        )
        assert isinstance(heard.message, Data)
        return Heard(heard.message, heard.time_ns)

    async def _fresh(self, timeout_s: float, stale: int = _STALE) -> Heard[Data]:
        """Return the first frame of the stream that was measured from now on; LinkTimeout if there is none."""
        try:
            with self._streamed.subscribe() as frames:
                async with within(min(timeout_s, _STREAMS_S), of=f"{self.name} stream"):
                    for _ in range(stale):
                        await frames.get()
                    return await frames.get()
        except TimeoutError:
            raise LinkTimeout(f"{self.name}: no reading in {min(timeout_s, _STREAMS_S):g} s") from None

    async def _greet(self, dialogue: Dialogue[Message]) -> None:
        """Silence the stream, see who is there, and go over to trigger mode; what cannot be silenced is read so."""
        self._is_first = False
        dialogue.post(OUTPUT_OFF)
        try:
            await dialogue.ask(VERSION, _is_version, timeout_s=_ANSWER_S, tries=_TRIES)
        except LinkTimeout:
            await self._greet_first(dialogue)
        else:
            dialogue.post(FORMAT_CM + RATE_0 + OUTPUT_ON)

    async def _greet_first(self, dialogue: Dialogue[Message]) -> None:
        """See whether it is one that answers nothing and streams; raises LinkTimeout if nothing is heard of it."""
        if self._model is Model.TFMINI:
            dialogue.post(FIRST_STANDARD)
        await self._fresh(_STREAMS_S, stale=0)  # any frame shows that there is a stream
        if self._model is not Model.TFMINI:
            raise RemoteProtocolError(
                f"{self.name}: it streams readings and answers no command: a TFmini of the first generation "
                f'(dialect = "{Model.TFMINI}"), or its RX wire is not connected'
            )
        self._is_first = True

    async def _attend(self, dialogue: Dialogue[Message]) -> NoReturn:
        """It speaks only when asked, so that it is still there must be asked; one that streams is heard."""
        if self._is_first:
            await dialogue.until_lost(self._silence_s)
        while True:
            await dialogue.until_idle(_IDLE_POLL_S)
            await dialogue.ask(VERSION, _is_version, timeout_s=_ANSWER_S, tries=_TRIES, despite_stops=True)

    def _report(self, heard: Heard[Message]) -> None:
        """Let go by echoes and late answers; a reading that nobody asked for may be a stream, which is ended again.

        It streams if it was switched off and on, or missed what it was told when greeted.
        """
        if not isinstance(heard.message, Data):
            return
        self._streamed.publish(Heard(heard.message, heard.time_ns))
        if self._dialogue is not None and not self._is_first:
            self._dialogue.post(RATE_0)


def _is_data(message: Message) -> bool:
    return isinstance(message, Data)


def _is_version(message: Message) -> bool:
    return isinstance(message, TfminiReply) and message.number == VERSION_NUMBER
