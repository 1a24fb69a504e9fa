"""The laser rangefinder on our own board."""

from typing import ClassVar

from firmware_proto import rangefinder_messages as proto
from firmware_proto.common import BoardKind
from firmware_proto.rangefinder_messages import ShotStatus
from robotd.core.errors import DeviceError, LinkTimeout
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.board_device import BoardDevice
from robotd.hardware.devices.dialect_options import BoardRangefinderSettings
from robotd.hardware.devices.instrument import Instrument
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.session import Session

_REACH_M = 500.0
"""As far as the strongest instrument here: the board does not say which one it carries."""
_MM_PER_M = 1000
_STATUS: dict[int, ReadingStatus] = {
    ShotStatus.OK: ReadingStatus.OK,
    ShotStatus.OVER_RANGE: ReadingStatus.MISS,
    ShotStatus.TOO_NEAR: ReadingStatus.TOO_NEAR,
    ShotStatus.WEAK: ReadingStatus.WEAK,
    ShotStatus.SATURATED: ReadingStatus.SATURATED,
    ShotStatus.AMBIENT: ReadingStatus.AMBIENT,
    ShotStatus.NOT_MEASURED: ReadingStatus.NOT_MEASURED,
    ShotStatus.LASER_OFF: ReadingStatus.DEVICE_ERROR,
    ShotStatus.DEVICE_ERROR: ReadingStatus.DEVICE_ERROR,
}


class BoardRangefinder(BoardDevice):
    """Implements :class:`robotd.hardware.devices.rangefinder.Rangefinder`."""

    KIND: ClassVar[BoardKind] = BoardKind.RANGEFINDER

    def __init__(self, settings: BoardRangefinderSettings, wiring: Wiring) -> None:
        """Make the device; its bias is applied to every range."""
        super().__init__(settings, wiring)
        self._instrument = Instrument(settings, _REACH_M)

    async def switch_laser(self, *, on: bool) -> None:
        """Switch the light; same errors as :meth:`arm`."""
        await self._talk().command(proto.SetLaser(int(on)))

    async def shoot(self, *, timeout_s: float) -> Shot:
        """Take one reading; TransportError if the device is absent, any other failure is a result."""
        session = self._talk()
        try:
            # The same seq for each repeat, so that a shot that was answered is not taken a second time.
            shot = await session.ask(proto.Shoot(max(1, round(timeout_s * 1000))), proto.Shot, takes_s=timeout_s)
        except LinkTimeout:
            return Shot(session.heard_ns, ReadingStatus.TIMEOUT, None, None)
        except DeviceError:
            return Shot(session.heard_ns, ReadingStatus.DEVICE_ERROR, None, None)
        return self._measured(shot, session)

    def _measured(self, shot: proto.Shot, session: Session) -> Shot:
        try:
            with self._judging():
                time_ns = self._host_ns(shot.board_us)
        except DeviceError:
            return Shot(session.heard_ns, ReadingStatus.DEVICE_ERROR, None, None)
        status = _STATUS.get(shot.status, ReadingStatus.DEVICE_ERROR)  # one of a later version is no reading
        if status is not ReadingStatus.OK:
            return Shot(time_ns, status, None, shot.strength)
        return self._instrument.shot(time_ns, shot.range_mm / _MM_PER_M, shot.strength)

    def _unlikely(self) -> int:
        return self._instrument.implausible
