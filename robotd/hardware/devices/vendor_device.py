"""What the adapters of vendor devices share: the line, health, and an arming that is ours, for makers know none."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar, Generic, NoReturn, TypeVar

from robotd.contract.device_status import LinkState
from robotd.core.errors import DeviceError, RemoteProtocolError, TransportError
from robotd.core.together import together
from robotd.hardware.devices.credible import IMPLAUSIBLE
from robotd.hardware.devices.device import PAST_LOOP_EVERY
from robotd.hardware.devices.health import Health
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.devices.with_health import WithHealth
from robotd.hardware.link.dialogue import Dialogue, DialogueCounters, Heard, Wire
from robotd.hardware.link.keep_up import keep_up
from robotd.hardware.link.seen_at_rest import seen_at_rest
from robotd.hardware.link.tapped import TappedLine

M = TypeVar("M")

_WAITING = "line open, waiting for the device"


class VendorDevice(WithHealth, ABC, Generic[M]):
    """A device that speaks its maker's protocol: a subclass adds what it measures and what it moves.

    It implements :class:`robotd.hardware.devices.device.Device`. Nothing on the line arms or latches a fault, so both
    are kept here: a fault is latched by :meth:`_latch`, and only :meth:`clear_faults` and then :meth:`arm` end it.
    """

    NAME: ClassVar[str]
    """``drive``, ``pantilt`` or ``rangefinder``."""
    STOP: bytes
    """What stops all that moves or shines, preformatted; safe to send at any time."""

    def __init__(self, wire: Wire[M], wiring: Wiring, *, quiet_s: float = 0.05) -> None:
        """Make the device; nothing happens before :meth:`run`."""
        self._wire = wire
        self._wiring = wiring
        self._quiet_s = quiet_s
        self._counters = DialogueCounters()
        self._dialogue: Dialogue[M] | None = None
        self._ending: Dialogue[M] | None = None
        """The conversation that is over but for the stop, while it is waited for the device to rest."""
        self._may_move = False
        """Whether it was armed, and no stop since."""
        self._stops = 0
        """Counted, so that an arm sees that one came while it was on its way."""
        self._health = Health(self.NAME, self._counted)

    @property
    def name(self) -> str:
        """``drive``, ``pantilt`` or ``rangefinder``."""
        return self.NAME

    @property
    def sessions(self) -> int:
        """How often the right device was found since start."""
        return self._counters.sessions

    async def run(self) -> None:
        """Own the line until cancelled: connect, greet, serve, reconnect with back-off, never arm by itself."""
        await keep_up(self.NAME, self._wiring.connect, self._wiring.tap, self)

    async def arm(self) -> None:
        """Allow motion; see :meth:`robotd.hardware.devices.device.Device.arm`."""
        if self._health.faults:
            raise DeviceError(self.NAME, "fault", f"{', '.join(self._health.faults)} latched: clear first")
        dialogue, stops = self._talk(), self._stops
        try:
            await self._enable(dialogue)
        except BaseException:
            self.stop_now()  # whatever came between: half enabled is not armed, and must not stay so
            raise
        if self._stops != stops:
            self.stop_now()
            raise DeviceError(self.NAME, "stopped", "while arming")
        if self._dialogue is not dialogue:
            raise TransportError(f"{self.NAME} was lost: {self._health.detail}")
        self._may_move = True
        self._health.change(armed=True)

    async def clear_faults(self) -> None:
        """Acknowledge latched faults; leaves the device disarmed; same errors as :meth:`arm`."""
        dialogue = self._talk()
        self.stop_now()  # as our own boards do: a clear leaves a device disarmed
        stops = self._stops
        await self._acknowledge(dialogue)
        if self._stops != stops:
            raise DeviceError(self.NAME, "stopped", "while clearing")  # by somebody, or by a fault that is new
        self._health.change(faults=(), detail="")

    def stop_now(self) -> None:
        """Put the preformatted stop on the wire in place of all that waits; never blocks, never raises.

        Nothing may move until the next :meth:`arm`. No device acknowledges it: a subclass whose device reports that it
        still moves says it again.
        """
        self._stops += 1
        self._may_move = False
        if self._dialogue is not None:
            self._dialogue.stop_now(self.STOP)
        self._health.change(armed=False)

    def stop_past_loop(self, before: int = 0) -> None:
        """Put the stop on the wire from any thread, while the loop is stuck; see :class:`.Device`."""
        self._may_move = False
        dialogue = self._dialogue or self._ending  # the loop may stall while it comes to rest, too
        data = self._past_loop(before)
        if dialogue is not None and data:
            dialogue.stop_past_loop(data)

    # What the line tells

    async def talk(self, line: TappedLine) -> NoReturn:
        """Greet the device that is there and serve until lost; see :class:`robotd.hardware.link.keep_up.Talker`."""
        self._health.change(link=LinkState.CONNECTING, armed=False, detail=_WAITING)
        dialogue = Dialogue(
            self.NAME, line, self._wire, counters=self._counters, on_report=self._report, quiet_s=self._quiet_s
        )
        async with dialogue:
            try:
                await self._greet(dialogue)
                self._counters.sessions += 1
                self._dialogue = dialogue
                found = self._health.detail  # what it said of itself when it was greeted
                self._health.change(link=LinkState.READY, armed=False, detail="" if found == _WAITING else found)
                await together(self._attend(dialogue), dialogue.until_lost())
            except BaseException as error:  # whatever ended it, nothing must go on moving
                self._dialogue, self._ending = None, dialogue
                dialogue.stop_now(self.STOP)
                if isinstance(error, Exception):
                    self.line_lost(str(error))  # the others are stopped now, not when this one was seen to rest
                if not isinstance(error, RemoteProtocolError):  # a stranger is told no more
                    await seen_at_rest(self._come_to_rest(dialogue))
                raise
            finally:
                self._ending = None

    def line_lost(self, reason: str) -> None:
        """Note that there is no device, and why; latched faults stay latched, for the device does not keep them."""
        self._may_move = False
        self._health.change(link=LinkState.ABSENT, armed=False, detail=reason)

    # What a subclass adds

    @abstractmethod
    async def _greet(self, dialogue: Dialogue[M]) -> None:
        """Make sure that the right device is there, at rest, and set it up; the first bytes sent are a stop.

        Raises:
            LinkTimeout: nobody answers.
            RemoteProtocolError: somebody else does; says what was expected.
        """

    @abstractmethod
    async def _attend(self, dialogue: Dialogue[M]) -> NoReturn:
        """Do what must be done while it is there (polls, keep-alive) until it is lost; raise why."""

    @abstractmethod
    def _report(self, heard: Heard[M]) -> None:
        """Take a message that nobody asked for."""

    async def _enable(self, dialogue: Dialogue[M]) -> None:
        """Make it ready to move; nothing to do for most."""

    async def _acknowledge(self, dialogue: Dialogue[M]) -> None:
        """Tell it that its faults were seen; nothing to do for most."""

    async def _come_to_rest(self, dialogue: Dialogue[M]) -> None:
        """Say the stop again, as the dialect needs it, until the device reports that it rests.

        One that moves nothing, or cannot say whether it moves, is not waited for.
        """

    def _past_loop(self, before: int) -> bytes:
        """Return what is next of the stop that a thread says, ``before`` pieces after it began; empty if nothing is."""
        return self.STOP if before % PAST_LOOP_EVERY == 0 else b""

    # What a subclass uses

    def _talk(self) -> Dialogue[M]:
        """Return the conversation; TransportError if there is none."""
        if self._dialogue is None:
            raise TransportError(f"{self.NAME} is absent: {self._health.detail}")
        return self._dialogue

    def _talk_armed(self) -> Dialogue[M]:
        """Return the conversation of an armed device; DeviceError, code ``not_armed``, if it is not."""
        dialogue = self._talk()
        if not self._may_move:
            raise DeviceError(self.NAME, "not_armed", "arm first")
        return dialogue

    def _latch(self, fault: str, detail: str = "") -> None:
        """Stop and latch a fault until it is cleared."""
        self.stop_now()
        if fault not in self._health.faults:
            self._health.change(faults=(*self._health.faults, fault), detail=detail)

    def _distrust(self, error: DeviceError) -> None:
        """Count that it said what cannot be, stop, and latch it."""
        self._counters.implausible += 1
        self._latch(IMPLAUSIBLE, str(error))

    def _counted(self) -> tuple[tuple[str, int], ...]:
        ours = (
            ("sessions", self._counters.sessions),
            ("retries", self._counters.retries),
            ("timeouts", self._counters.timeouts),
            ("implausible", self._counters.implausible + self._unlikely()),
        )
        return (*self._wire.counters.items(), *ours)


def is_a(*kinds: type) -> Callable[[object], bool]:
    """Return a test for messages of some kinds, for :meth:`Dialogue.ask`."""
    return lambda message: isinstance(message, kinds)
