"""An RWI base (B12, B14, B21) on its two-letter ASCII line.

Speeds are magnitudes and directions are commands, so a reversal stops first and goes on with the next set-point. Every
set-point re-arms the base's own watchdog for its time to live: when the host falls silent, the base stops by itself.
"""

import contextlib
import math
from typing import ClassVar, NoReturn

from robotd.core.angles import wrap_rad
from robotd.core.broadcast import Broadcast
from robotd.core.clock import NS_PER_S
from robotd.core.errors import DeviceError
from robotd.core.pose import Odometry, Twist2
from robotd.hardware.devices.credible import IMPLAUSIBLE, battery_v
from robotd.hardware.devices.drive import DriveReadout
from robotd.hardware.devices.odometer import JudgedOdometer
from robotd.hardware.devices.settings import DriveSettings
from robotd.hardware.devices.vendor_device import VendorDevice
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.dialogue import Dialogue, Heard
from robotd.hardware.wire.rwi_ascii import (
    BUMPERS_NONE,
    STOP_BYTES,
    TICKS_PER_S,
    Message,
    Report,
    RwiAnswer,
    RwiEvent,
    RwiWire,
    command,
)

_ANSWER_S = 0.3
"""Three tries of it are the 0.9 s within which a silent base is lost (docs/safety.md)."""
_TRIES = 3
_WATCHDOG_MAX_TICKS = 0xFE
"""Some bases take eight bits; never 0, which may mean off."""
_ACCELERATION_MPS2 = 0.5
_TURN_ACCELERATION_RADPS2 = 1.5
_SPEED_MAX_COUNTS = 0xFFFF
_PANELS = 8
_BATTERY_EVERY_POLLS = 100
"""A question for the battery costs odometry a turn on a line of 9600 baud."""
_TENTHS_PER_V = 10
_FAULTS = {"BLO": "battery", "TERR": "servo", "RERR": "servo", "TC": "current", "RC": "current"}


class RwiDrive(VendorDevice[Message]):
    """Implements :class:`robotd.hardware.devices.drive.Drive`."""

    NAME: ClassVar[str] = "drive"
    STOP = STOP_BYTES

    def __init__(self, settings: DriveSettings, wiring: Wiring) -> None:
        """Make the device; its ``odom`` frame begins where the base is first seen."""
        super().__init__(RwiWire(), wiring)
        self._scales = settings.calibration
        self._odometer = JudgedOdometer(self.NAME, settings.calibration)
        self.odometry: Broadcast[Odometry] = Broadcast()
        """Wheel-derived pose, as quickly as the line allows."""
        self.readouts: Broadcast[DriveReadout] = Broadcast()
        """Battery and bumpers, periodic and on change."""
        self._directions = {"T": 0, "R": 0}
        """Which way each axis was last told to run."""
        self._bumpers_rad: tuple[float, ...] = ()

    @property
    def is_driven(self) -> bool:
        """Whether a set-point other than standstill was given, and no stop since."""
        return any(self._directions.values())

    def set_velocity(self, twist: Twist2, ttl_s: float) -> None:
        """Send a set-point that the base may follow for ``ttl_s``; TransportError if it is absent.

        Raises:
            DeviceError: it is not armed.
        """
        dialogue = self._talk_armed()
        ticks = min(max(1, round(ttl_s * TICKS_PER_S)), _WATCHDOG_MAX_TICKS)
        orders = [command("WD", ticks)]  # first: the base never moves unwatched
        orders += self._axis("T", twist.speed_mps * self._scales.counts_per_m)
        orders += self._axis("R", twist.turn_radps * self._scales.counts_per_rad)
        dialogue.post(b"".join(orders))

    def stop_now(self) -> None:
        """Put the preformatted stop on the wire; see :meth:`VendorDevice.stop_now`."""
        self._directions = {"T": 0, "R": 0}
        super().stop_now()

    def line_lost(self, reason: str) -> None:
        """Note that there is no base, and why."""
        self.readouts.forget()
        self._bumpers_rad = ()
        super().line_lost(reason)

    def _axis(self, axis: str, counts_per_s: float) -> list[bytes]:
        """Return the orders that give an axis a signed speed."""
        speed = min(round(abs(counts_per_s)), _SPEED_MAX_COUNTS)
        wanted = 0 if speed == 0 else (1 if counts_per_s > 0.0 else -1)
        before = self._directions[axis]
        # The base ramps down before it turns round; an order for the other way meanwhile is lost.
        if wanted == 0 or before == -wanted:
            self._directions[axis] = 0
            return [command(f"{axis}H")] if before else []
        self._directions[axis] = wanted
        run = [] if before == wanted else [command(f"{axis}{'+' if wanted > 0 else '-'}")]
        return [command(f"{axis}V", speed), *run]  # speed first, or it starts at the one before

    async def _greet(self, dialogue: Dialogue[Message]) -> None:
        dialogue.post(STOP_BYTES + command("HD"))
        self._directions = {"T": 0, "R": 0}
        # Asked before anything is set: a line with nobody at its end takes every order.
        await self._ask(dialogue, "TW")
        translate = round(_ACCELERATION_MPS2 * abs(self._scales.counts_per_m))
        rotate = round(_TURN_ACCELERATION_RADPS2 * abs(self._scales.counts_per_rad))
        for mnemonic, argument in (
            ("JD", 1),  # no joystick
            ("SP", 0),  # no reports: positions are asked for
            ("ED", 0x80),  # half a second from error to shutdown
            ("TT", 0x64),
            ("TA", translate),
            ("RA", rotate),
            ("BE", 0),  # stop on bump
            ("EA", 0),
        ):
            dialogue.post(command(mnemonic, argument))

    async def _attend(self, dialogue: Dialogue[Message]) -> NoReturn:
        """Ask where the wheels are, again and again: what comes paces the set-points."""
        before: Heard[RwiAnswer] | None = None
        counts_before = (0, 0)
        polls = 0
        while True:
            translate = await self._ask(dialogue, "TW")
            rotate = await self._ask(dialogue, "RW")
            counts = (_signed(translate.message.value), _signed(rotate.message.value))
            try:
                with self._judging():
                    in_odom = self._odometer.update(self.sessions, *counts, rotate.time_ns)
            except DeviceError:
                before = None  # what comes next is judged by what came before
                continue
            if before is not None:
                seconds = max(rotate.time_ns - before.time_ns, 1) / NS_PER_S
                twist = Twist2(
                    _signed(counts[0] - counts_before[0]) / self._scales.counts_per_m / seconds,
                    _signed(counts[1] - counts_before[1]) / self._scales.counts_per_rad / seconds,
                )
                self.odometry.publish(Odometry(rotate.time_ns, in_odom, twist, self._odometer.counts))
                self._say_stop_again(twist)
            before, counts_before = rotate, counts
            if polls % _BATTERY_EVERY_POLLS == 0:
                self._read_out(await self._ask(dialogue, "BV"))
            polls += 1

    async def _come_to_rest(self, dialogue: Dialogue[Message]) -> None:
        """Say the stop before each look at the wheels, until they were twice where they were."""
        before: tuple[int, int] | None = None
        while True:
            dialogue.post(STOP_BYTES)
            translate = await self._ask(dialogue, "TW")
            rotate = await self._ask(dialogue, "RW")
            counts = translate.message.value, rotate.message.value
            # Twice the same: the base reports no speed, and one look cannot tell standing from the turning
            # point of a slow creep.
            if counts == before:
                return
            before = counts

    def _say_stop_again(self, twist: Twist2) -> None:
        """A stop can be lost like any command: a base that moves though nobody may let it is told again."""
        if not self._may_move and not twist.is_zero:
            self.stop_now()

    def _report(self, heard: Heard[Message]) -> None:
        message = heard.message
        if isinstance(message, (RwiAnswer, Report)) or self._dialogue is None:
            return
        self._hear(message, heard.time_ns)

    def _hear(self, event: RwiEvent, time_ns: int) -> None:
        if event.name == "BS" and event.value is not None:
            self._bumped(event.value, time_ns)
        elif event.name == "WDT" and any(self._directions.values()):  # a base that was told to stand may let it run out
            self._latch("deadman", "the base's watchdog ran out: no set-point came in time")
        for name, fault in _FAULTS.items():
            if event.name.startswith(name) and not event.name.endswith("CLR"):
                self._latch(fault, f"the base says %{event.name}")

    def _bumped(self, switches: int, time_ns: int) -> None:
        panels = sorted({bit // 2 for bit in range(2 * _PANELS) if not switches & 1 << bit})
        # Panel 0 begins straight ahead. Which way round they follow is not documented; the base counts clockwise.
        self._bumpers_rad = tuple(wrap_rad(-(panel + 0.5) * math.tau / _PANELS) for panel in panels)
        latest = self.readouts.latest
        self.readouts.publish(DriveReadout(time_ns, latest.battery_v if latest else None, self._bumpers_rad))
        if switches != BUMPERS_NONE:
            self._latch("bumper", "the base was bumped")

    def _read_out(self, battery: Heard[RwiAnswer]) -> None:
        with contextlib.suppress(DeviceError), self._judging():
            volts = battery_v(self.NAME, battery.message.value / _TENTHS_PER_V)
            self.readouts.publish(DriveReadout(battery.time_ns, volts, self._bumpers_rad))

    async def _acknowledge(self, dialogue: Dialogue[Message]) -> None:
        """End the errors that the base has latched: after a servo or current error it runs no motor before."""
        dialogue.post(command("EA", 0))
        if IMPLAUSIBLE in self._health.faults:
            self._odometer.start_again()

    async def _ask(self, dialogue: Dialogue[Message], mnemonic: str) -> Heard[RwiAnswer]:
        def settles(message: Message) -> bool:
            return isinstance(message, RwiAnswer) and message.mnemonic == mnemonic

        heard = await dialogue.ask(command(mnemonic), settles, timeout_s=_ANSWER_S, tries=_TRIES, despite_stops=True)
        assert isinstance(heard.message, RwiAnswer)
        return Heard(heard.message, heard.time_ns)


def _signed(value: int) -> int:
    """Return the signed number of a 32-bit counter, or the shorter way from one count to another.

    >>> _signed(0xFFFFFFFF)
    -1
    """
    return (value + 0x80000000) % 0x100000000 - 0x80000000
