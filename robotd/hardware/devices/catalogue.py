"""Which adapter speaks which dialect. A new dialect is one row here."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

from firmware_proto.common import BoardKind
from robotd.core.errors import ConfigError
from robotd.hardware.devices.board_drive import BoardDrive
from robotd.hardware.devices.board_pantilt import BoardPanTilt
from robotd.hardware.devices.board_rangefinder import BoardRangefinder
from robotd.hardware.devices.dimetix_rangefinder import DimetixRangefinder
from robotd.hardware.devices.drive import Drive
from robotd.hardware.devices.dynamixel_pantilt import DynamixelPanTilt
from robotd.hardware.devices.fixed_pantilt import FixedPanTilt
from robotd.hardware.devices.lw20_rangefinder import Lw20Rangefinder
from robotd.hardware.devices.lwnx_rangefinder import LwnxRangefinder
from robotd.hardware.devices.pantilt import PanTilt
from robotd.hardware.devices.ptu_pantilt import PtuPanTilt
from robotd.hardware.devices.rangefinder import Rangefinder
from robotd.hardware.devices.rflex_drive import RflexDrive
from robotd.hardware.devices.rwi_drive import RwiDrive
from robotd.hardware.devices.scip_rangefinder import ScipRangefinder
from robotd.hardware.devices.settings import DriveSettings, PanTiltSettings, PortSettings, RangefinderSettings
from robotd.hardware.devices.tfmini_rangefinder import TfminiRangefinder
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.wire import dimetix, disto, dynamixel, lw20, lwnx, ptu, rflex, rwi_ascii, scip, tfmini
from robotd.hardware.wire.board import requests_to
from robotd.hardware.wire.tfmini import Model
from robotd.hardware.wire.word import Words

S_contra = TypeVar("S_contra", bound=PortSettings, contravariant=True)
D_co = TypeVar("D_co", covariant=True)

Adapter = Callable[[S_contra, Wiring], D_co]


@dataclass(frozen=True, slots=True)
class Dialect(Generic[S_contra, D_co]):
    """One way to talk to a kind of device."""

    adapter: Adapter[S_contra, D_co]
    line: LineFormat
    """What such a device is usually set to."""
    words: Words | None
    """What bytes to it ask for; None if it has no line."""


_OURS = LineFormat(115_200)

DRIVES: Mapping[str, Dialect[DriveSettings, Drive]] = {
    "board": Dialect(BoardDrive, _OURS, requests_to(BoardKind.DRIVE)),
    "rwi-ascii": Dialect(RwiDrive, LineFormat(9_600), rwi_ascii.requests),
    "rflex": Dialect(RflexDrive, LineFormat(115_200), rflex.requests),
}
PANTILTS: Mapping[str, Dialect[PanTiltSettings, PanTilt]] = {
    "board": Dialect(BoardPanTilt, _OURS, requests_to(BoardKind.PANTILT)),
    "ptu": Dialect(PtuPanTilt, LineFormat(9_600), ptu.requests),
    "fixed": Dialect(FixedPanTilt, LineFormat(9_600), None),  # it has no line
    "dynamixel": Dialect(DynamixelPanTilt, LineFormat(57_600), dynamixel.requests),
}
RANGEFINDERS: Mapping[str, Dialect[RangefinderSettings, Rangefinder]] = {
    "board": Dialect(BoardRangefinder, _OURS, requests_to(BoardKind.RANGEFINDER)),
    "dimetix": Dialect(DimetixRangefinder, LineFormat(19_200, 7, "E", 1), dimetix.requests),
    "disto": Dialect(DimetixRangefinder, LineFormat(9_600, 7, "E", 1), disto.requests),
    "lw20": Dialect(Lw20Rangefinder, LineFormat(115_200), lw20.requests),
    "lwnx": Dialect(LwnxRangefinder, LineFormat(115_200), lwnx.requests),
    "scip": Dialect(ScipRangefinder, LineFormat(115_200), scip.requests),
    **{model.value: Dialect(TfminiRangefinder, LineFormat(115_200), tfmini.requests) for model in Model},
}
MOTORLESS, SCANNERS = "fixed", ("scip",)
"""A head without a motor needs a rangefinder that looks all round by itself, and such a one needs it."""

DIALECTS: Mapping[str, Mapping[str, Dialect[PortSettings, object]]] = {
    "drive": DRIVES,  # type: ignore[dict-item]  # whoever looks here makes no adapter
    "pantilt": PANTILTS,  # type: ignore[dict-item]  # as above
    "rangefinder": RANGEFINDERS,  # type: ignore[dict-item]  # as above
}
"""All of them, by device."""


def drive(settings: DriveSettings, wiring: Wiring) -> Drive:
    """Return the drive that the settings describe; ConfigError if nothing speaks its dialect."""
    return _spoken("drive", DRIVES, settings).adapter(settings, wiring)


def pantilt(settings: PanTiltSettings, wiring: Wiring) -> PanTilt:
    """Return the pan/tilt unit that the settings describe; ConfigError if nothing speaks its dialect."""
    return _spoken("pantilt", PANTILTS, settings).adapter(settings, wiring)


def rangefinder(settings: RangefinderSettings, wiring: Wiring) -> Rangefinder:
    """Return the rangefinder that the settings describe; ConfigError if nothing speaks its dialect."""
    return _spoken("rangefinder", RANGEFINDERS, settings).adapter(settings, wiring)


def line_format(device: str, settings: PortSettings) -> LineFormat:
    """Return how to set a device's serial line; ConfigError if nothing speaks its dialect."""
    usual = _spoken(device, DIALECTS[device], settings).line
    return LineFormat.parse(settings.line) if settings.line else usual


def request_words(devices: Mapping[str, PortSettings]) -> dict[str, Words]:
    """Return what the bytes to each of some devices mean, in its dialect; a device without a line has no words."""
    words = {device: _spoken(device, DIALECTS[device], settings).words for device, settings in devices.items()}
    return {device: its_words for device, its_words in words.items() if its_words is not None}


T = TypeVar("T")


def _spoken(device: str, table: Mapping[str, T], settings: PortSettings) -> T:
    if settings.dialect not in table:
        raise ConfigError(
            f"no {device} speaks {settings.dialect!r}; known: {', '.join(table)}", key=f"{device}.dialect"
        )
    return table[settings.dialect]
