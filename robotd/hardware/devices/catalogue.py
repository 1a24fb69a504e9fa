"""Which adapter speaks which dialect. A new dialect is one row here."""

from collections.abc import Callable, Mapping
from typing import TypeVar

from robotd.core.errors import ConfigError
from robotd.hardware.devices.board_drive import BoardDrive
from robotd.hardware.devices.board_pantilt import BoardPanTilt
from robotd.hardware.devices.board_rangefinder import BoardRangefinder
from robotd.hardware.devices.drive import Drive
from robotd.hardware.devices.pantilt import PanTilt
from robotd.hardware.devices.rangefinder import Rangefinder
from robotd.hardware.devices.settings import DriveSettings, PanTiltSettings, RangefinderSettings
from robotd.hardware.devices.wiring import Wiring

T = TypeVar("T")

DRIVES: Mapping[str, Callable[[DriveSettings, Wiring], Drive]] = {"board": BoardDrive}
PANTILTS: Mapping[str, Callable[[PanTiltSettings, Wiring], PanTilt]] = {"board": BoardPanTilt}
RANGEFINDERS: Mapping[str, Callable[[RangefinderSettings, Wiring], Rangefinder]] = {"board": BoardRangefinder}


def drive(settings: DriveSettings, wiring: Wiring) -> Drive:
    """Return the drive that the settings describe; ConfigError if nothing speaks its dialect."""
    return _adapter("drive", DRIVES, settings.dialect)(settings, wiring)


def pantilt(settings: PanTiltSettings, wiring: Wiring) -> PanTilt:
    """Return the pan/tilt unit that the settings describe; ConfigError if nothing speaks its dialect."""
    return _adapter("pantilt", PANTILTS, settings.dialect)(settings, wiring)


def rangefinder(settings: RangefinderSettings, wiring: Wiring) -> Rangefinder:
    """Return the rangefinder that the settings describe; ConfigError if nothing speaks its dialect."""
    return _adapter("rangefinder", RANGEFINDERS, settings.dialect)(settings, wiring)


def _adapter(device: str, table: Mapping[str, T], dialect: str) -> T:
    if dialect not in table:
        raise ConfigError(f"no {device} speaks {dialect!r}; known: {', '.join(table)}", key=f"{device}.dialect")
    return table[dialect]
