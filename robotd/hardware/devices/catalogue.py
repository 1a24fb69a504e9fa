"""All that each dialect brings: its options, its adapter, its line, its words, its hazards. A new one is one row here.

Its emulator is one row in ``robotd/sim/emulators/catalogue.py``, which the daemon never imports.
"""

from collections.abc import Mapping
from typing import TypeVar

from firmware_proto.common import BoardKind
from robotd.core.errors import ConfigError
from robotd.hardware.devices.board_drive import BoardDrive, BoardDriveSettings
from robotd.hardware.devices.board_pantilt import BoardPanTilt, BoardPanTiltSettings
from robotd.hardware.devices.board_rangefinder import BoardRangefinder, BoardRangefinderSettings
from robotd.hardware.devices.dialect import Dialect, Line
from robotd.hardware.devices.dimetix_rangefinder import DimetixRangefinder, DimetixSettings
from robotd.hardware.devices.drive import Drive
from robotd.hardware.devices.dynamixel_pantilt import DynamixelPanTilt, DynamixelSettings
from robotd.hardware.devices.fixed_pantilt import FixedHeadSettings, FixedPanTilt
from robotd.hardware.devices.lw20_rangefinder import Lw20Rangefinder
from robotd.hardware.devices.lwnx_rangefinder import LwnxRangefinder
from robotd.hardware.devices.pantilt import PanTilt
from robotd.hardware.devices.ptu_pantilt import PtuPanTilt
from robotd.hardware.devices.rangefinder import Rangefinder
from robotd.hardware.devices.rflex_drive import RflexDrive, RflexSettings
from robotd.hardware.devices.rwi_drive import RwiDrive
from robotd.hardware.devices.scip_rangefinder import ScipRangefinder
from robotd.hardware.devices.settings import DriveSettings, PanTiltSettings, PortSettings, RangefinderSettings
from robotd.hardware.devices.tfmini_rangefinder import TfminiRangefinder, TfminiSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.wire import dimetix, disto, dynamixel, lw20, lwnx, ptu, rflex, rwi_ascii, scip, tfmini
from robotd.hardware.wire.board import BoardWire, enquiry_to, requests_to
from robotd.hardware.wire.enquiry import NotAsked
from robotd.hardware.wire.word import Words

S = TypeVar("S", bound=PortSettings)
D = TypeVar("D")

_OURS = LineFormat(115_200)
"""As PROTOCOL.md has it: it carries all telemetry with room, and USB ports ignore it."""
_MOVES = NotAsked("what is written to such a device may move it, for nothing arms it")

DRIVES: Mapping[str, Dialect[DriveSettings, Drive]] = {
    "board": Dialect(
        BoardDriveSettings,
        BoardDrive,
        Line(_OURS, BoardWire, requests_to(BoardKind.DRIVE), enquiry_to(BoardKind.DRIVE)),
    ),
    "rwi-ascii": Dialect(
        DriveSettings,
        RwiDrive,
        Line(LineFormat(9_600), rwi_ascii.RwiWire, rwi_ascii.requests, _MOVES),
        ("Which way round the bumpers of an RWI base are numbered is not documented.",),
    ),
    "rflex": Dialect(
        RflexSettings,
        RflexDrive,
        Line(LineFormat(115_200), rflex.RflexWire, rflex.requests, _MOVES),
        ("An rFLEX base has no watchdog: if the computer dies while it drives, it goes on driving.",),
    ),
}
PANTILTS: Mapping[str, Dialect[PanTiltSettings, PanTilt]] = {
    "board": Dialect(
        BoardPanTiltSettings,
        BoardPanTilt,
        Line(_OURS, BoardWire, requests_to(BoardKind.PANTILT), enquiry_to(BoardKind.PANTILT)),
    ),
    "ptu": Dialect(
        PanTiltSettings,
        PtuPanTilt,
        Line(LineFormat(9_600), ptu.PtuWire, ptu.requests, _MOVES),
        ("A reset turns both axes of a PTU to their stops, for up to half a minute.",),
    ),
    "fixed": Dialect(FixedHeadSettings, FixedPanTilt, line=None),
    "dynamixel": Dialect(
        DynamixelSettings,
        DynamixelPanTilt,
        Line(LineFormat(57_600), dynamixel.DynamixelWire, dynamixel.requests, dynamixel.ENQUIRY),
        ("A Dynamixel head goes limp when it is stopped, and a heavy one may drop.",),
    ),
}
RANGEFINDERS: Mapping[str, Dialect[RangefinderSettings, Rangefinder]] = {
    "board": Dialect(
        BoardRangefinderSettings,
        BoardRangefinder,
        Line(_OURS, BoardWire, requests_to(BoardKind.RANGEFINDER), enquiry_to(BoardKind.RANGEFINDER)),
    ),
    "dimetix": Dialect(
        DimetixSettings,
        DimetixRangefinder,
        Line(LineFormat(19_200, 7, "E", 1), dimetix.DimetixWire, dimetix.requests, dimetix.ENQUIRY),
    ),
    "disto": Dialect(
        RangefinderSettings,
        DimetixRangefinder,
        Line(LineFormat(9_600, 7, "E", 1), dimetix.DimetixWire, disto.requests, disto.ENQUIRY),
    ),
    "lw20": Dialect(
        RangefinderSettings, Lw20Rangefinder, Line(LineFormat(115_200), lw20.Lw20Wire, lw20.requests, lw20.ENQUIRY)
    ),
    "lwnx": Dialect(
        RangefinderSettings, LwnxRangefinder, Line(LineFormat(115_200), lwnx.LwnxWire, lwnx.requests, lwnx.ENQUIRY)
    ),
    "scip": Dialect(
        RangefinderSettings, ScipRangefinder, Line(LineFormat(115_200), scip.ScipWire, scip.requests, scip.ENQUIRY)
    ),
    **{
        model.value: Dialect(
            TfminiSettings,
            TfminiRangefinder,
            Line(LineFormat(115_200), tfmini.TfminiWire, tfmini.requests, tfmini.enquiry_to(model)),
            ("A TFmini cannot switch its light off.",),
        )
        for model in tfmini.Model
    },
}
MOTORLESS, SCANNERS = "fixed", ("scip",)
"""A head without a motor needs a rangefinder that looks all round by itself, and such a one needs it."""

DIALECTS: Mapping[str, Mapping[str, Dialect[PortSettings, Drive | PanTilt | Rangefinder]]] = {
    "drive": DRIVES,
    "pantilt": PANTILTS,
    "rangefinder": RANGEFINDERS,
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


def line_format(device: str, settings: PortSettings) -> LineFormat | None:
    """Return how to set a device's serial line, None if it has none; ConfigError if nothing speaks its dialect."""
    line = _spoken(device, DIALECTS[device], settings).line
    if line is None:
        return None
    return LineFormat.parse(settings.line) if settings.line else line.usual


def request_words(devices: Mapping[str, PortSettings]) -> dict[str, Words]:
    """Return what the bytes to each of some devices mean, in its dialect; a device without a line has no words."""
    lines = {device: _spoken(device, DIALECTS[device], settings).line for device, settings in devices.items()}
    return {device: line.words for device, line in lines.items() if line is not None}


def _spoken(device: str, table: Mapping[str, Dialect[S, D]], settings: PortSettings) -> Dialect[S, D]:
    if settings.dialect not in table:
        raise ConfigError(
            f"no {device} speaks {settings.dialect!r}; known: {', '.join(table)}", key=f"{device}.dialect"
        )
    dialect = table[settings.dialect]
    if not isinstance(settings, dialect.options):
        raise ConfigError(
            f"{device} speaks {settings.dialect!r}: expected {dialect.options.__name__}, got {type(settings).__name__}",
            key=device,
        )
    return dialect
