"""What talks in each dialect: its adapter, what reads and tells the bytes of its line, its question.

Options, usual line and hazards of the same dialect are its row in ``dialects.py``; its emulator is one in
``robotd/sim/emulators/catalogue.py``, which the daemon never imports.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from firmware_proto.common import BoardKind
from robotd.hardware.devices.board_drive import BoardDrive
from robotd.hardware.devices.board_pantilt import BoardPanTilt
from robotd.hardware.devices.board_rangefinder import BoardRangefinder
from robotd.hardware.devices.dialects import dialect_of
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
from robotd.hardware.wire import dimetix, disto, dynamixel, lw20, lwnx, ptu, rflex, rwi_ascii, scip, tfmini
from robotd.hardware.wire.board import BoardWire, enquiry_to, requests_to
from robotd.hardware.wire.enquiry import Enquiry, NotAsked
from robotd.hardware.wire.word import Words

D_co = TypeVar("D_co", covariant=True)


@dataclass(frozen=True, slots=True)
class Speech:
    """What passes on the line to a device, each way."""

    wire: type[object]
    """Reads what comes from it."""
    words: Words
    """Say what is written to it."""
    enquiry: Enquiry | NotAsked
    """How it is found where nobody said what is plugged in."""


@dataclass(frozen=True, slots=True)
class Speaker(Generic[D_co]):
    """What talks in a dialect."""

    adapter: Callable[[Any, Wiring], D_co]
    """Makes the device from its options."""
    speech: Speech | None
    """None for a device without a line."""


_MOVES = NotAsked("what is written to such a device may move it, for nothing arms it")


def _board(kind: BoardKind) -> Speech:
    return Speech(BoardWire, requests_to(kind), enquiry_to(kind))


DRIVES: Mapping[str, Speaker[Drive]] = {
    "board": Speaker(BoardDrive, _board(BoardKind.DRIVE)),
    "rwi-ascii": Speaker(RwiDrive, Speech(rwi_ascii.RwiWire, rwi_ascii.requests, _MOVES)),
    "rflex": Speaker(RflexDrive, Speech(rflex.RflexWire, rflex.requests, _MOVES)),
}
PANTILTS: Mapping[str, Speaker[PanTilt]] = {
    "board": Speaker(BoardPanTilt, _board(BoardKind.PANTILT)),
    "ptu": Speaker(PtuPanTilt, Speech(ptu.PtuWire, ptu.requests, _MOVES)),
    "fixed": Speaker(FixedPanTilt, speech=None),
    "dynamixel": Speaker(DynamixelPanTilt, Speech(dynamixel.DynamixelWire, dynamixel.requests, dynamixel.ENQUIRY)),
}
RANGEFINDERS: Mapping[str, Speaker[Rangefinder]] = {
    "board": Speaker(BoardRangefinder, _board(BoardKind.RANGEFINDER)),
    "dimetix": Speaker(DimetixRangefinder, Speech(dimetix.DimetixWire, dimetix.requests, dimetix.ENQUIRY)),
    "disto": Speaker(DimetixRangefinder, Speech(dimetix.DimetixWire, disto.requests, disto.ENQUIRY)),
    "lw20": Speaker(Lw20Rangefinder, Speech(lw20.Lw20Wire, lw20.requests, lw20.ENQUIRY)),
    "lwnx": Speaker(LwnxRangefinder, Speech(lwnx.LwnxWire, lwnx.requests, lwnx.ENQUIRY)),
    "scip": Speaker(ScipRangefinder, Speech(scip.ScipWire, scip.requests, scip.ENQUIRY)),
    **{
        model.value: Speaker(TfminiRangefinder, Speech(tfmini.TfminiWire, tfmini.requests, tfmini.enquiry_to(model)))
        for model in tfmini.Model
    },
}
SPEAKERS: Mapping[str, Mapping[str, Speaker[Drive | PanTilt | Rangefinder]]] = {
    "drive": DRIVES,
    "pantilt": PANTILTS,
    "rangefinder": RANGEFINDERS,
}
"""All of them, by device and dialect."""


def drive(settings: DriveSettings, wiring: Wiring) -> Drive:
    """Return the drive that the settings describe; ConfigError if nothing speaks its dialect."""
    dialect_of("drive", settings)
    return DRIVES[settings.dialect].adapter(settings, wiring)


def pantilt(settings: PanTiltSettings, wiring: Wiring) -> PanTilt:
    """Return the pan/tilt unit that the settings describe; ConfigError if nothing speaks its dialect."""
    dialect_of("pantilt", settings)
    return PANTILTS[settings.dialect].adapter(settings, wiring)


def rangefinder(settings: RangefinderSettings, wiring: Wiring) -> Rangefinder:
    """Return the rangefinder that the settings describe; ConfigError if nothing speaks its dialect."""
    dialect_of("rangefinder", settings)
    return RANGEFINDERS[settings.dialect].adapter(settings, wiring)


def request_words(devices: Mapping[str, PortSettings]) -> dict[str, Words]:
    """Return what the bytes to each of some devices mean, in its dialect; a device without a line has no words.

    Raises:
        ConfigError: nothing speaks one of their dialects.
    """
    words: dict[str, Words] = {}
    for device, settings in devices.items():
        dialect_of(device, settings)
        speech = SPEAKERS[device][settings.dialect].speech
        if speech is not None:
            words[device] = speech.words
    return words
