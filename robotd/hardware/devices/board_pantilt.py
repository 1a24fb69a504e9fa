"""The pan/tilt unit on our own board."""

import asyncio
import math
from typing import ClassVar

from firmware_proto import pantilt_messages as proto
from firmware_proto.common import BoardKind
from firmware_proto.schema import Message
from robotd.core.angles import wrap_rad
from robotd.core.broadcast import Broadcast, Subscription
from robotd.core.errors import DeviceError, LinkTimeout, TransportError
from robotd.core.silence import within
from robotd.hardware.devices.board_device import BoardDevice
from robotd.hardware.devices.credible import check_limits, check_readback
from robotd.hardware.devices.dialect_options import BoardPanTiltSettings
from robotd.hardware.devices.pantilt import AimReadback, PanTiltLimits
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.session import Session

_PER_RAD = 10_000
"""The wire counts tenths of a milliradian."""
_HALF_TURN = 31_415
"""Of the head, in wire units, rounded so that a head without end still reaches it."""
_TTL_MARGIN_MS = 250
"""The board's deadman is for a host that is gone; a slow head is halted by us before."""
_TTL_LIMIT_MS = 0xFFFF
"""What its field holds."""
_QUIET_PERIODS = 3
"""This many periods of telemetry without a report, and we ask."""

Report = proto.AimReport | proto.AimReadback


class BoardPanTilt(BoardDevice):
    """Implements :class:`robotd.hardware.devices.pantilt.PanTilt`."""

    KIND: ClassVar[BoardKind] = BoardKind.PANTILT
    REPORTED: ClassVar[frozenset[str]] = frozenset({"armed", "moving"})

    def __init__(self, settings: BoardPanTiltSettings, wiring: Wiring) -> None:
        """Make the device; angles outside it have the zeros of its mount applied."""
        super().__init__(settings, wiring)
        self._mount = settings.mount
        self._quiet_s = _QUIET_PERIODS * settings.telemetry_ms / 1000
        self._reports: Broadcast[Report | None] = Broadcast()
        """What the head says of itself; None when it is lost."""
        self._one_at_a_time = asyncio.Lock()

    async def limits(self) -> PanTiltLimits:
        """Return the mechanical limits, in the robot frame; a head without end pans from -pi to pi there."""
        limits = await self._talk().ask(proto.ReadLimits(), proto.Limits)
        is_endless = limits.pan_max_tenth_mrad - limits.pan_min_tenth_mrad >= 2 * _HALF_TURN
        found = PanTiltLimits(
            -math.pi if is_endless else self._pan_rad(limits.pan_min_tenth_mrad),
            math.pi if is_endless else self._pan_rad(limits.pan_max_tenth_mrad),
            self._tilt_rad(limits.tilt_min_tenth_mrad),
            self._tilt_rad(limits.tilt_max_tenth_mrad),
        )
        with self._judging():
            check_limits(self.name, found)
        return found

    async def reset(self) -> None:
        """Do nothing: it measures where it points."""

    async def aim(self, pan_rad: float, tilt_rad: float, *, timeout_s: float) -> AimReadback:
        """Turn the head and return where it came to rest; see :meth:`robotd.hardware.devices.pantilt.PanTilt.aim`."""
        aim = proto.Aim(
            pan_tenth_mrad=_pan_of_head(pan_rad - self._mount.pan_zero_rad),
            tilt_tenth_mrad=round((tilt_rad - self._mount.tilt_zero_rad) * _PER_RAD),
            # Longer than we wait: a slow head is then halted by us, which is no fault, and not by its deadman,
            # which is one.
            ttl_ms=min(round(timeout_s * 1000) + _TTL_MARGIN_MS, _TTL_LIMIT_MS),
        )
        async with self._one_at_a_time:
            session = self._talk()
            # Before the Aim goes out: the report that it is done may come together with its Ack.
            with self._reports.subscribe() as reports:
                try:
                    async with within(timeout_s, of=f"{self.name} aim"):
                        done = await self._done(session, await session.command(aim), reports)
                except TimeoutError:
                    self.stop_now()
                    raise LinkTimeout(f"{self.name}: still turning after {timeout_s:g} s") from None
        with self._judging():
            readback = self._readback(done)
            check_readback(self.name, readback, pan_rad, tilt_rad)
        return readback

    async def _done(self, session: Session, seq: int, reports: Subscription[Report | None]) -> Report:
        while True:
            report = await self._next_report(session, reports)
            # What is told of another aim is late: the newest one counts.
            if report.aim_seq != seq or report.moving == proto.Motion.TURNING:
                continue
            if report.moving == proto.Motion.DONE:
                return report
            # A report from before the session's first AIM may carry the same seq; an answer from now cannot be old.
            if (await session.ask(proto.ReadAim(), proto.AimReadback)).moving == proto.Motion.HALTED:
                raise DeviceError(self.name, "halted", "something stopped the head on its way")

    async def _next_report(self, session: Session, reports: Subscription[Report | None]) -> Report:
        """Return the next report, or ask for one if none comes: telemetry may be lost."""
        try:
            async with within(self._quiet_s, of=f"{self.name} report"):
                report = await reports.get()
        except TimeoutError:
            return await session.ask(proto.ReadAim(), proto.AimReadback)
        if report is None:
            raise TransportError(f"{self.name} was lost: {self.status.detail}")
        return report

    def telemetry(self, message: Message) -> None:
        """Take where the head points, and what every board tells."""
        if isinstance(message, proto.AimReport):
            self._rest.told("moving", goes_on=message.moving == proto.Motion.TURNING)
            self._reports.publish(message)
        else:
            super().telemetry(message)

    def link_lost(self, reason: str) -> None:
        """Note it, and let those who wait for the head know."""
        super().link_lost(reason)
        # Else who waits for the head would wait until its own time runs out.
        self._reports.publish(None)

    def _readback(self, report: Report) -> AimReadback:
        return AimReadback(
            self._host_ns(report.board_us), self._pan_rad(report.pan_tenth_mrad), self._tilt_rad(report.tilt_tenth_mrad)
        )

    def _pan_rad(self, tenth_mrad: int) -> float:
        return tenth_mrad / _PER_RAD + self._mount.pan_zero_rad

    def _tilt_rad(self, tenth_mrad: int) -> float:
        return tenth_mrad / _PER_RAD + self._mount.tilt_zero_rad


def _pan_of_head(pan_rad: float) -> int:
    """Return a pan in wire units; beyond a half turn, the same direction from the other side."""
    tenth_mrad = round(pan_rad * _PER_RAD)
    if abs(tenth_mrad) <= _HALF_TURN:
        return tenth_mrad
    return max(-_HALF_TURN, min(round(wrap_rad(pan_rad) * _PER_RAD), _HALF_TURN))  # pi itself rounds to one unit beyond
