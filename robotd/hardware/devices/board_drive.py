"""The synchro-drive on our own board."""

import contextlib
import math
from typing import ClassVar

from firmware_proto.common import BoardKind
from firmware_proto.drive_messages import DriveReport, OdometryReport, SetVelocity
from firmware_proto.schema import Message
from robotd.core.angles import wrap_rad
from robotd.core.broadcast import Broadcast
from robotd.core.errors import DeviceError
from robotd.core.pose import STANDSTILL, Odometry, Twist2
from robotd.hardware.devices.board_device import BoardDevice
from robotd.hardware.devices.credible import battery_v, check_twist
from robotd.hardware.devices.dialect_options import BoardDriveSettings
from robotd.hardware.devices.drive import DriveReadout
from robotd.hardware.devices.odometer import JudgedOdometer
from robotd.hardware.devices.wiring import Wiring

_MILLI = 1000
_BUMPERS = 16
"""Bits of ``bumpers``, counter-clockwise from the heading (PROTOCOL.md)."""
_BUMPER_STEP_RAD = math.tau / _BUMPERS


class BoardDrive(BoardDevice):
    """Implements :class:`robotd.hardware.devices.drive.Drive`."""

    KIND: ClassVar[BoardKind] = BoardKind.DRIVE
    REPORTED: ClassVar[frozenset[str]] = frozenset({"armed", "moving"})

    def __init__(self, settings: BoardDriveSettings, wiring: Wiring) -> None:
        """Make the device; its ``odom`` frame begins where the base is first seen."""
        super().__init__(settings, wiring)
        self._odometer = JudgedOdometer(self.name, settings.calibration)
        self.odometry: Broadcast[Odometry] = Broadcast()
        """Wheel-derived pose, periodic."""
        self.readouts: Broadcast[DriveReadout] = Broadcast()
        """Battery and bumpers, periodic and on change."""
        self._wanted = STANDSTILL

    @property
    def is_driven(self) -> bool:
        """Whether a set-point other than standstill was given, and no stop since."""
        return not self._wanted.is_zero

    def stop_now(self) -> None:
        """Put the preformatted stop on the wire; see :meth:`BoardDevice.stop_now`."""
        self._wanted = STANDSTILL
        super().stop_now()

    def link_lost(self, reason: str) -> None:
        """Note that there is no base, and why."""
        self._wanted = STANDSTILL
        self.readouts.forget()
        super().link_lost(reason)

    def set_velocity(self, twist: Twist2, ttl_s: float) -> None:
        """Send a set-point that the base may follow for ``ttl_s``; TransportError if it is absent."""
        session = self._talk()
        # Before it is sent: the guard's thread must find a base that is driven as driven, not a moment too
        # late.
        self._wanted = twist
        session.post(
            SetVelocity(
                speed_mmps=round(twist.speed_mps * _MILLI),
                turn_mradps=round(twist.turn_radps * _MILLI),
                ttl_ms=max(1, round(ttl_s * _MILLI)),  # 0 would be refused
            )
        )

    def telemetry(self, message: Message) -> None:
        """Take odometry, battery, bumpers, and what every board tells."""
        # A lie is latched and ends there: let through, it would end the reader, and with it the link.
        with contextlib.suppress(DeviceError), self._judging():
            if isinstance(message, OdometryReport):
                # Before it is judged: a base that lies about where it is still says whether it moves.
                self._rest.told("moving", goes_on=bool(message.speed_mmps or message.turn_mradps))
                self._moved(message)
            elif isinstance(message, DriveReport):
                self.readouts.publish(self._read_out(message))
            else:
                super().telemetry(message)

    async def clear_faults(self) -> None:
        """Acknowledge latched faults; see :meth:`BoardDevice.clear_faults`."""
        if self._is_distrusted:
            # The counts from before the lie lead nowhere: odometry goes on from the next ones, without a jump.
            self._odometer.start_again()
        await super().clear_faults()

    def _moved(self, report: OdometryReport) -> None:
        """Publish where it is; a report older than the last one, as a line that doubles bytes gives, is let go."""
        time_ns = self._host_ns(report.board_us, periodic=True)
        latest = self.odometry.latest
        if latest is not None and time_ns < latest.time_ns:
            return
        twist = Twist2(report.speed_mmps / _MILLI, report.turn_mradps / _MILLI)
        check_twist(self.name, twist)
        # A board that booted begins its counts again: by its number the odometer sees that they lead nowhere.
        boot_id = self._talk().boot_id
        in_odom = self._odometer.update(boot_id, report.translate_counts, report.rotate_counts, time_ns)
        self.odometry.publish(Odometry(time_ns, in_odom, twist, self._odometer.counts))

    def _read_out(self, report: DriveReport) -> DriveReadout:
        pressed = (bit for bit in range(_BUMPERS) if report.bumpers & 1 << bit)
        return DriveReadout(
            time_ns=self._host_ns(report.board_us),
            battery_v=battery_v(self.name, report.battery_mv / _MILLI),
            bumpers_rad=tuple(wrap_rad(bit * _BUMPER_STEP_RAD) for bit in pressed),
        )
