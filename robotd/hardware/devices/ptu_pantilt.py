"""A FLIR / Directed Perception pan/tilt unit.

It turns open loop: what it reads back are the steps it commanded, so an axis that met its stop (``!P``, ``!T``) has
lost steps and knows no longer where it points. It is halted, and refuses to aim until it is reset, which turns both
axes to their stops and takes up to half a minute: a mission resets it and looks again, and so does
:meth:`PtuPanTilt.clear_faults`.
"""

import asyncio
import math
from dataclasses import dataclass
from typing import NoReturn

from robotd.core.angles import wrap_rad
from robotd.core.errors import DeviceError, LinkTimeout, RemoteProtocolError
from robotd.core.silence import within
from robotd.core.together import together
from robotd.hardware.devices.credible import check_limits
from robotd.hardware.devices.pantilt import LOST_STEPS, AimReadback, PanTiltLimits
from robotd.hardware.devices.settings import PanTiltSettings
from robotd.hardware.devices.vendor_device import VendorDevice, is_a
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue, Heard
from robotd.hardware.wire.ptu import STOP_BYTES, Banner, Done, LimitHit, Message, PtuWire, Refused, command

RESET_S = 40.0
"""A reset takes up to 30 s."""
_ANSWER_S = 0.5
_TRIES = 3
_HALT_S = 0.1
"""Three tries of it fit into the time that a device has to come to rest."""
_IDLE_POLL_S = 1.0
_FINEST_ARC_SECONDS, _COARSEST_ARC_SECONDS = 0.1, 3600.0
"""Of a step. A resolution outside was misread, and would bend every angle."""
_ARC_SECONDS_PER_RAD = 3600.0 * 180.0 / math.pi


@dataclass(frozen=True, slots=True)
class _Axes:
    """What the unit says of itself when greeted."""

    pan_steps_per_rad: float
    tilt_steps_per_rad: float
    limits_steps: tuple[int, int, int, int]
    """Pan min, pan max, tilt min, tilt max."""


class PtuPanTilt(VendorDevice[Message]):
    """Implements :class:`robotd.hardware.devices.pantilt.PanTilt`."""

    NAME = "pantilt"
    STOP = STOP_BYTES

    def __init__(self, settings: PanTiltSettings, wiring: Wiring) -> None:
        """Make the device; angles outside it have the zeros of its mount applied."""
        super().__init__(PtuWire(), wiring)
        self._mount = settings.mount
        self._axes: _Axes | None = None
        self._is_resetting = False
        self._lost_steps = ""
        """Which axis met its stop, in a sentence, and has not been reset since."""
        self._was_stopped = asyncio.Event()
        self._one_aim = asyncio.Lock()

    async def limits(self) -> PanTiltLimits:
        """Return the limits that the unit found at its last reset, in the robot frame."""
        self._talk()
        return self._in_robot(self._known_axes())

    def _in_robot(self, axes: _Axes) -> PanTiltLimits:
        pan_min, pan_max, tilt_min, tilt_max = axes.limits_steps
        return PanTiltLimits(
            pan_min / axes.pan_steps_per_rad + self._mount.pan_zero_rad,
            pan_max / axes.pan_steps_per_rad + self._mount.pan_zero_rad,
            tilt_min / axes.tilt_steps_per_rad + self._mount.tilt_zero_rad,
            tilt_max / axes.tilt_steps_per_rad + self._mount.tilt_zero_rad,
        )

    async def aim(self, pan_rad: float, tilt_rad: float, *, timeout_s: float) -> AimReadback:
        """Turn the head and return where it came to rest; see :meth:`robotd.hardware.devices.pantilt.PanTilt.aim`."""
        async with self._one_aim:
            dialogue, axes = self._talk_armed(), self._known_axes()
            self._check_steps()
            pan = round(self._pan_of_head(pan_rad) * axes.pan_steps_per_rad)
            tilt = round((tilt_rad - self._mount.tilt_zero_rad) * axes.tilt_steps_per_rad)
            try:
                async with within(timeout_s, of=f"{self.name} aim"):
                    await self._order(dialogue, command("PP", pan))
                    await self._order(dialogue, command("TP", tilt))
                    time_ns = await self._arrived(dialogue, pan, tilt)
            except TimeoutError:
                self.stop_now()
                raise LinkTimeout(f"{self.name}: still turning after {timeout_s:g} s") from None
            except DeviceError:
                self._check_steps()  # they are why it was stopped
                raise
        # Of the steps that it went to, not of the angle that was asked: it points where whole steps lead.
        return AimReadback(
            time_ns,
            pan / axes.pan_steps_per_rad + self._mount.pan_zero_rad,
            tilt / axes.tilt_steps_per_rad + self._mount.tilt_zero_rad,
        )

    async def reset(self) -> None:
        """Turn both axes to their stops; see :meth:`robotd.hardware.devices.pantilt.PanTilt.reset`."""
        async with self._one_aim:
            await self._find_stops(self._talk_armed())

    async def _arrived(self, dialogue: Dialogue[Message], pan: int, tilt: int) -> int:
        """Ask where the head is until it is there; return when that was said."""
        while True:
            at_pan = await self._order(dialogue, command("PP"))
            at_tilt = await self._order(dialogue, command("TP"))
            self._talk_armed()
            self._check_steps()
            # Exactly: it counts the steps that it commands, so it is there or it is not.
            if (_whole(at_pan.message), _whole(at_tilt.message)) == (pan, tilt):
                return at_tilt.time_ns

    async def _greet(self, dialogue: Dialogue[Message]) -> None:
        dialogue.stop_now(STOP_BYTES)
        for mode in ("FT", "ED", "CI", "I", "LE"):  # terse, no echo, independent, at once, limits enforced
            await self._set_up(dialogue, mode)
        numbers = [await self._number(dialogue, query) for query in ("PR", "TR", "PN", "PX", "TN", "TX")]
        pan_arc_seconds, tilt_arc_seconds, *limits = numbers
        if not all(_FINEST_ARC_SECONDS <= one <= _COARSEST_ARC_SECONDS for one in (pan_arc_seconds, tilt_arc_seconds)):
            raise RemoteProtocolError(f"{self.name}: expected seconds of arc per step, got {numbers[:2]}")
        pan_min, pan_max, tilt_min, tilt_max = (int(limit) for limit in limits)
        axes = _Axes(
            _ARC_SECONDS_PER_RAD / pan_arc_seconds,
            _ARC_SECONDS_PER_RAD / tilt_arc_seconds,
            (pan_min, pan_max, tilt_min, tilt_max),
        )
        try:
            check_limits(self.name, self._in_robot(axes))
        except DeviceError as error:
            self._counters.implausible += 1
            raise RemoteProtocolError(str(error)) from error
        self._axes = axes

    async def _attend(self, dialogue: Dialogue[Message]) -> NoReturn:
        await together(self._poll(dialogue), self._halt_again(dialogue))

    async def _poll(self, dialogue: Dialogue[Message]) -> NoReturn:
        """It speaks only when asked, so that it is still there must be asked."""
        while True:
            await dialogue.until_idle(_IDLE_POLL_S)
            if not self._is_resetting:
                await dialogue.ask(
                    command("PP"), is_a(Done, Refused), timeout_s=_ANSWER_S, tries=_TRIES, despite_stops=True
                )

    async def _halt_again(self, dialogue: Dialogue[Message]) -> NoReturn:
        """Say each stop once more, until it is answered: one may be lost on the wire."""
        while True:
            await self._was_stopped.wait()
            self._was_stopped.clear()
            if not self._is_resetting and not self._may_move:
                await dialogue.ask(
                    STOP_BYTES, is_a(Done, Refused), timeout_s=_ANSWER_S, tries=_TRIES, despite_stops=True
                )

    def stop_now(self) -> None:
        """Put the halt on the wire; see :meth:`VendorDevice.stop_now`."""
        super().stop_now()
        self._was_stopped.set()

    async def _come_to_rest(self, dialogue: Dialogue[Message]) -> None:
        """Halt it until it says so and is twice where it was; while it resets it does not listen."""
        before: tuple[int | None, int | None] | None = None
        while not self._is_resetting:
            at = [
                (
                    await dialogue.ask(data, is_a(Done, Refused), timeout_s=_HALT_S, tries=_TRIES, despite_stops=True)
                ).message
                for data in (STOP_BYTES, command("PP"), command("TP"))
            ]
            here = _whole(at[1]), _whole(at[2])
            if isinstance(at[0], Done) and here == before:
                return
            before = here

    async def _acknowledge(self, dialogue: Dialogue[Message]) -> None:
        """Reset, if it does not know where it points: both axes turn to their stops."""
        if self._health.faults or self._lost_steps:
            await self._find_stops(dialogue)

    async def _find_stops(self, dialogue: Dialogue[Message]) -> None:
        self._is_resetting = True
        try:
            # One try: a second reset would turn it to its stops again.
            answer = (await dialogue.ask(command("R"), is_a(Done, Refused), timeout_s=RESET_S)).message
            if isinstance(answer, Refused):
                raise DeviceError(self.name, "refused", f"to reset: {answer.text}")
        finally:
            self._is_resetting = False
        self._lost_steps = ""
        self._health.change(detail="")

    def _check_steps(self) -> None:
        if self._lost_steps:
            raise DeviceError(self.name, LOST_STEPS, self._lost_steps)

    def _report(self, heard: Heard[Message]) -> None:
        message = heard.message
        if isinstance(message, LimitHit) and not self._is_resetting and self._dialogue is not None:
            axis = "pan" if message.axis == "P" else "tilt"
            self._lost_steps = f"the {axis} axis met its stop: it must be reset"
            self._dialogue.stop_now(STOP_BYTES)  # it is halted, not disarmed: a mission may reset it
            self._health.change(detail=self._lost_steps)
        elif isinstance(message, Banner) and "PAN-TILT" in message.text.upper() and self._dialogue is not None:
            self._latch("restarted", "the unit was switched off and on, and found its stops again")

    async def _order(self, dialogue: Dialogue[Message], data: bytes) -> Heard[Message]:
        heard = await dialogue.ask(data, is_a(Done, Refused), timeout_s=_ANSWER_S, tries=_TRIES)
        if isinstance(heard.message, Refused):
            raise DeviceError(self.name, "refused", heard.message.text)
        return heard

    async def _set_up(self, dialogue: Dialogue[Message], mode: str) -> None:
        heard = await dialogue.ask(command(mode), is_a(Done, Refused), timeout_s=_ANSWER_S, tries=_TRIES)
        if isinstance(heard.message, Refused):
            raise RemoteProtocolError(f"{self.name}: refused {mode}: {heard.message.text}")

    async def _number(self, dialogue: Dialogue[Message], query: str) -> float:
        heard = await dialogue.ask(command(query), is_a(Done, Refused), timeout_s=_ANSWER_S, tries=_TRIES)
        number = heard.message.number if isinstance(heard.message, Done) else None
        if number is None:
            raise RemoteProtocolError(f"{self.name}: expected a number for {query}, got {heard.message}")
        return number

    def _known_axes(self) -> _Axes:
        if self._axes is None:
            raise DeviceError(self.name, "unknown", "it was never greeted")
        return self._axes

    def _pan_of_head(self, pan_rad: float) -> float:
        """Return the pan of the head; beyond a half turn, the same direction from the other side."""
        pan_rad -= self._mount.pan_zero_rad
        return pan_rad if abs(pan_rad) <= math.pi else wrap_rad(pan_rad)


def _whole(message: Message) -> int | None:
    number = message.number if isinstance(message, Done) else None
    return None if number is None else round(number)
