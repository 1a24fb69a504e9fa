"""Which dialects each device can speak, as a configuration has to know them: options, usual line, hazards.

What talks in them is in ``catalogue.py``, which stands on this, a row for each again: who only reads, checks or writes
a configuration loads no adapter.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

from robotd.core.errors import ConfigError
from robotd.hardware.devices.dialect_options import (
    BoardDriveSettings,
    BoardPanTiltSettings,
    BoardRangefinderSettings,
    DimetixSettings,
    DynamixelSettings,
    FixedHeadSettings,
    RflexSettings,
    TfminiSettings,
)
from robotd.hardware.devices.settings import DriveSettings, PanTiltSettings, PortSettings, RangefinderSettings
from robotd.hardware.transport.line_format import LineFormat

S_co = TypeVar("S_co", bound=PortSettings, covariant=True)


@dataclass(frozen=True, slots=True)
class Dialect(Generic[S_co]):
    """One way to talk to a kind of device."""

    options: type[S_co]
    """Its section of the configuration: the options of the device, and those of this dialect alone."""
    line: LineFormat | None
    """What such a device is usually set to; None for a device without a line."""
    hazards: tuple[str, ...] = ()
    """What anyone who stands beside the robot must know, in sentences; ``docs/devices.md`` says them, too."""


_OURS = LineFormat(115_200)
"""As PROTOCOL.md has it: it carries all telemetry with room, and USB ports ignore it."""

DRIVES: Mapping[str, Dialect[DriveSettings]] = {
    "board": Dialect(BoardDriveSettings, _OURS),
    "rwi-ascii": Dialect(
        DriveSettings,
        LineFormat(9_600),
        ("Which way round the bumpers of an RWI base are numbered is not documented.",),
    ),
    "rflex": Dialect(
        RflexSettings,
        LineFormat(115_200),
        ("An rFLEX base has no watchdog: if the computer dies while it drives, it goes on driving.",),
    ),
}
PANTILTS: Mapping[str, Dialect[PanTiltSettings]] = {
    "board": Dialect(BoardPanTiltSettings, _OURS),
    "ptu": Dialect(
        PanTiltSettings,
        LineFormat(9_600),
        ("A reset turns both axes of a PTU to their stops, for up to half a minute.",),
    ),
    "fixed": Dialect(FixedHeadSettings, line=None),
    "dynamixel": Dialect(
        DynamixelSettings,
        LineFormat(57_600),
        ("A Dynamixel head goes limp when it is stopped, and a heavy one may drop.",),
    ),
}
_TFMINI = Dialect(TfminiSettings, LineFormat(115_200), ("A TFmini cannot switch its light off.",))
RANGEFINDERS: Mapping[str, Dialect[RangefinderSettings]] = {
    "board": Dialect(BoardRangefinderSettings, _OURS),
    "dimetix": Dialect(DimetixSettings, LineFormat(19_200, 7, "E", 1)),
    "disto": Dialect(RangefinderSettings, LineFormat(9_600, 7, "E", 1)),
    "lw20": Dialect(RangefinderSettings, LineFormat(115_200)),
    "lwnx": Dialect(RangefinderSettings, LineFormat(115_200)),
    "scip": Dialect(RangefinderSettings, LineFormat(115_200)),
    "tfmini": _TFMINI,
    "tfmini-s": _TFMINI,
    "tfmini-plus": _TFMINI,
    "tf-luna": _TFMINI,
}
MOTORLESS, SCANNERS = "fixed", ("scip",)
"""A head without a motor needs a rangefinder that looks all round by itself, and such a one needs it."""

DIALECTS: Mapping[str, Mapping[str, Dialect[PortSettings]]] = {
    "drive": DRIVES,
    "pantilt": PANTILTS,
    "rangefinder": RANGEFINDERS,
}
"""All of them, by device."""


def line_format(device: str, settings: PortSettings) -> LineFormat | None:
    """Return how to set a device's serial line, None if it has none; ConfigError if nothing speaks its dialect."""
    usual = dialect_of(device, settings).line
    return LineFormat.parse(settings.line) if usual is not None and settings.line else usual


def dialect_of(device: str, settings: PortSettings) -> Dialect[PortSettings]:
    """Return what a device speaks; ConfigError if nothing speaks that, or the settings are those of another dialect."""
    table = DIALECTS[device]
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
