"""An RWI base with an rFLEX controller (B14R, B21R, ATRV, Magellan Pro).

**The controller has no watchdog of its own.** A set-point holds until another comes: if this program is killed, or the
cable comes out while the base drives, the base goes on. What can be done here is done: a timer ends each set-point
after its time to live, a thread sends the stop when the event loop stands still, a lost line is opened and stopped
again, and the warning below is logged at every connection. None of that helps against a cut cable: such a robot needs
an emergency stop that a person can reach, or a relay that drops with the host.
"""

import asyncio
import contextlib
import logging
from collections.abc import Iterator
from itertools import cycle, islice
from typing import ClassVar, NoReturn

from robotd.core.broadcast import Broadcast
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError
from robotd.core.pose import STANDSTILL, Odometry, Twist2
from robotd.core.silence import within
from robotd.core.together import together
from robotd.hardware.devices.credible import IMPLAUSIBLE, battery_v, check_twist, implausible
from robotd.hardware.devices.dialect_options import RflexSettings
from robotd.hardware.devices.drive import DriveReadout
from robotd.hardware.devices.odometer import JudgedOdometer
from robotd.hardware.devices.vendor_device import VendorDevice, is_a
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue, Heard
from robotd.hardware.wire.rflex import (
    BRAKE_RELEASE,
    DEFAULTS,
    STATUS,
    AxisReport,
    Message,
    RflexWire,
    Switches,
    SystemStatus,
    report_every,
    safe_speed,
    set_direction,
    switches_every,
)

NO_WATCHDOG = (
    "this base has no watchdog of its own: if the host dies or the cable comes out while it drives, it goes on. "
    "Have an emergency stop within reach"
)

_ACCELERATIONS = (0.5, 1.5)
"""Of translation [m/s^2] and rotation [rad/s^2]."""
_TORQUES = (30_000, 35_000)
_TRANSLATION, _ROTATION = 0, 1
_US_PER_MS = 1000
_SPACING_S = 0.012
"""What comes less than 10 ms after another order may be dropped; clocks differ, and lines are late."""
_HALTS_LEAST = 4
"""Both axes twice: each heard alone, whatever came just before."""
_QUIET_S = 0.005
"""It reports on and on, so it is never quiet for long; and an answer that comes late is a voltage all the same."""
_ANSWER_S = 0.5
_TRIES = 3
_STATUS_EVERY_S = 5.0
_CENTIVOLTS_PER_V = 100
_FIRST_BUMPER, _LAST_BUMPER = 0x40, 0x4D
_CORNERS = 0x0F

log = logging.getLogger(__name__)

_HALT = tuple(set_direction(axis, 0, 1_000_000, torque, forwards=True) for axis, torque in enumerate(_TORQUES))


class RflexDrive(VendorDevice[Message]):
    """Implements :class:`robotd.hardware.devices.drive.Drive`."""

    NAME: ClassVar[str] = "drive"
    STOP = b"".join(_HALT)
    """Of a burst only the first may be heard, so both are said again, with pauses, until they are obeyed."""

    def __init__(self, settings: RflexSettings, wiring: Wiring) -> None:
        """Make the device; its ``odom`` frame begins where the base is first seen."""
        super().__init__(RflexWire(), wiring, quiet_s=_QUIET_S)
        self._settings = settings
        self._scales = settings.calibration
        self._odometer = JudgedOdometer(self.NAME, settings.calibration)
        self.odometry: Broadcast[Odometry] = Broadcast()
        """Wheel-derived pose, periodic."""
        self.readouts: Broadcast[DriveReadout] = Broadcast()
        """Battery, periodic."""
        self._translated: AxisReport | None = None
        self._wanted = STANDSTILL
        self._deadline_ns = 0
        self._new_set_point = asyncio.Event()
        self._standing: set[int] = set()
        """The axes that were reported to stand since a halt of each must have been heard."""
        self._calm = asyncio.Event()
        """Set unless a stop is being said."""
        self._calm.set()

    @property
    def is_driven(self) -> bool:
        """Whether a set-point other than standstill was given, and no stop since."""
        return not self._wanted.is_zero

    def set_velocity(self, twist: Twist2, ttl_s: float) -> None:
        """Let the base follow a set-point for ``ttl_s``; TransportError if it is absent, DeviceError if not armed."""
        self._talk_armed()
        self._wanted, self._deadline_ns = twist, now_ns() + round(ttl_s * NS_PER_S)
        self._new_set_point.set()

    def stop_now(self) -> None:
        """Put the preformatted stop on the wire; see :meth:`VendorDevice.stop_now`."""
        self._wanted = STANDSTILL
        self._calm.clear()
        self._new_set_point.set()
        super().stop_now()

    def line_lost(self, reason: str) -> None:
        """Note that there is no base, and why."""
        self.readouts.forget()
        super().line_lost(reason)

    async def _greet(self, dialogue: Dialogue[Message]) -> None:
        log.warning("%s: %s", self.NAME, NO_WATCHDOG)
        period_us = self._settings.telemetry_ms * _US_PER_MS
        self._translated = None
        self._wanted = STANDSTILL
        for order in (*_HALT, report_every(period_us), switches_every(period_us), DEFAULTS, BRAKE_RELEASE):
            dialogue.post(order)
            await asyncio.sleep(_SPACING_S)  # of a burst only the first is heard
        await dialogue.ask(STATUS, is_a(SystemStatus), timeout_s=_ANSWER_S, tries=_TRIES)

    async def _attend(self, dialogue: Dialogue[Message]) -> NoReturn:
        silence_s = self._settings.silence_s
        await together(self._pace(dialogue), self._watch_battery(dialogue), dialogue.until_lost(silence_s))

    async def _pace(self, dialogue: Dialogue[Message]) -> NoReturn:
        """Send the newest set-point, one axis after the other no quicker than is heard, and end it in its time."""
        sent = STANDSTILL
        while True:
            self._new_set_point.clear()
            if not self._calm.is_set():
                sent = STANDSTILL
                await self._come_to_rest(dialogue)
                self._calm.set()
            twist = self._wanted
            # Standstill once is enough, anything else is said again: a set-point that was lost must not leave
            # the base on the one before.
            if self._may_move and (twist != sent or not twist.is_zero):
                sent = twist
                for axis, counts_per_s in enumerate(self._counts(twist)):
                    if not (self._calm.is_set() and self._may_move):
                        break  # stopped since the axis before: nothing may follow a stop
                    dialogue.post(self._run(axis, counts_per_s))
                    await asyncio.sleep(_SPACING_S)
            if twist.is_zero:
                await self._new_set_point.wait()
                continue
            try:
                left_s = max(0.0, (self._deadline_ns - now_ns()) / NS_PER_S)
                # Stalls count: no watchdog is below, so a set-point ends in its time whether or not we listened.
                async with within(left_s, of=f"{self.name} set-point", counts_stalls=True):
                    await self._new_set_point.wait()
            except TimeoutError:
                sent = STANDSTILL
                self._latch("deadman", "no set-point came in time")

    async def _come_to_rest(self, dialogue: Dialogue[Message]) -> None:
        """Say the halts one at a time, no quicker than they are heard, until both axes were reported to stand."""
        for order in _halts(_HALTS_LEAST):
            await asyncio.sleep(_SPACING_S)
            dialogue.post(order)
        # After the first halts: a report of before them may be of a moment in which the base stood by chance.
        self._standing.clear()
        for order in _halts():
            await asyncio.sleep(_SPACING_S)
            if self._standing >= {_TRANSLATION, _ROTATION} or self._may_move:  # armed again: it has been told
                return
            dialogue.post(order)

    def _past_loop(self, before: int) -> bytes:
        # All of it once; then one halt a call, which come 15 ms apart, so that each is heard alone.
        return self.STOP if before == 0 else _HALT[before % len(_HALT)]

    async def _watch_battery(self, dialogue: Dialogue[Message]) -> NoReturn:
        while True:
            await self._calm.wait()  # a question in between is lost, or the halt is
            heard = await dialogue.ask(
                STATUS, is_a(SystemStatus), timeout_s=_ANSWER_S, tries=_TRIES, despite_stops=True
            )
            if isinstance(heard.message, SystemStatus):
                with contextlib.suppress(DeviceError), self._judging():
                    volts = battery_v(self.NAME, heard.message.centivolts / _CENTIVOLTS_PER_V)
                    self.readouts.publish(DriveReadout(heard.time_ns, volts, ()))
            await asyncio.sleep(_STATUS_EVERY_S)

    async def _acknowledge(self, dialogue: Dialogue[Message]) -> None:
        if IMPLAUSIBLE in self._health.faults:
            self._odometer.start_again()

    def _counts(self, twist: Twist2) -> tuple[float, float]:
        return twist.speed_mps * self._scales.counts_per_m, twist.turn_radps * self._scales.counts_per_rad

    def _run(self, axis: int, counts_per_s: float) -> bytes:
        scales = (self._scales.counts_per_m, self._scales.counts_per_rad)
        acceleration = safe_speed(round(abs(scales[axis]) * _ACCELERATIONS[axis]))
        speed = safe_speed(round(abs(counts_per_s)))
        return set_direction(axis, speed, acceleration, _TORQUES[axis], forwards=counts_per_s >= 0.0)

    def _report(self, heard: Heard[Message]) -> None:
        message = heard.message
        if isinstance(message, AxisReport):
            if message.speed:
                self._standing.discard(message.axis)
            else:
                self._standing.add(message.axis)
            with contextlib.suppress(DeviceError), self._judging():
                self._moved(message, heard.time_ns)
        elif isinstance(message, Switches) and self._dialogue is not None and _is_pressed(message):
            self._latch("bumper", f"bump panel {message.address - _FIRST_BUMPER}")

    def _moved(self, report: AxisReport, time_ns: int) -> None:
        """Publish odometry with each report of the rotation, which follows that of the translation."""
        if report.axis == _TRANSLATION:
            self._translated = report
            return
        if report.axis != _ROTATION:
            raise implausible(self.NAME, f"it reports an axis {report.axis}")
        # The first of a conversation may be half a pair: without its other half there is no place to tell.
        if self._translated is None or self._dialogue is None:
            return
        twist = Twist2(self._translated.speed / self._scales.counts_per_m, report.speed / self._scales.counts_per_rad)
        check_twist(self.NAME, twist)
        in_odom = self._odometer.update(self.sessions, self._translated.position, report.position, time_ns)
        self.odometry.publish(Odometry(time_ns, in_odom, twist, self._odometer.counts))
        if not self._may_move and not twist.is_zero and self._calm.is_set():
            self.stop_now()  # it moves though nobody may let it


def _halts(count: int | None = None) -> Iterator[bytes]:
    """Return the halts of the axes in turn, that of the rotation first: in a burst it is the one not heard."""
    return islice(cycle(reversed(_HALT)), count)


def _is_pressed(switches: Switches) -> bool:
    is_bumper = _FIRST_BUMPER <= switches.address <= _LAST_BUMPER
    return is_bumper and any(byte & _CORNERS for byte in switches.data[-2:])
