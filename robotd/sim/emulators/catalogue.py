"""Which emulator speaks which dialect. A new one is one row here, and in the tables of dialects and adapters."""

import enum
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Generic, TypeVar

from robotd.core.errors import ConfigError
from robotd.hardware.devices import dialects
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.wire.tfmini import Model
from robotd.sim.boards.drive_board import DriveBoard
from robotd.sim.boards.pantilt_board import PanTiltBoard
from robotd.sim.boards.rangefinder_board import RangefinderBoard
from robotd.sim.emulators import emulated_rflex, rwi
from robotd.sim.emulators.emulated_dimetix import DimetixEmulator
from robotd.sim.emulators.emulated_disto import DistoEmulator
from robotd.sim.emulators.emulated_dynamixel import DynamixelEmulator
from robotd.sim.emulators.emulated_lw20 import Lw20Emulator
from robotd.sim.emulators.emulated_lwnx import LwnxEmulator
from robotd.sim.emulators.emulated_ptu import PtuEmulator
from robotd.sim.emulators.emulated_rflex import RflexEmulator
from robotd.sim.emulators.emulated_scip import ScipEmulator
from robotd.sim.emulators.emulated_tfmini import TfminiEmulator
from robotd.sim.emulators.fixed import FixedEmulator
from robotd.sim.emulators.paced import Paced
from robotd.sim.emulators.rwi import RwiEmulator
from robotd.sim.hosting.host import HostedBoard
from robotd.sim.physics.plant import DrivePlant, HeadPlant, ScannerPlant

try:
    from robotd.sim.firmware import boards as firmware
except ImportError:  # no C compiler when robotd was installed
    firmware = None  # type: ignore[assignment]  # there is none

Plant = TypeVar("Plant")


@dataclass(frozen=True, slots=True)
class Emulator(Generic[Plant]):
    """One way in which an emulated device can talk."""

    power_up: Callable[[Plant, int], HostedBoard]
    """Given what is beneath it, and a number that differs from boot to boot."""
    settings: Mapping[str, object] = field(default_factory=dict)
    """What the daemon's configuration of the device must say, beside its dialect, to understand it."""


def _spoken(
    line: LineFormat | None, make: Callable[[Plant], HostedBoard], settings: Mapping[str, object] | None = None
) -> Emulator[Plant]:
    """Return an emulator that says its bytes no quicker than the line of its dialect takes them."""
    assert line is not None  # what speaks has a line
    return Emulator(lambda plant, _: Paced(make(plant), line), settings or {})


DRIVES: Mapping[str, Emulator[DrivePlant]] = {
    "board": Emulator(lambda plant, boot_id: DriveBoard(plant, boot_id=boot_id)),
    "rwi-ascii": _spoken(
        dialects.DRIVES["rwi-ascii"].line,
        RwiEmulator,
        {"counts_per_m": rwi.COUNTS_PER_M, "counts_per_rad": rwi.COUNTS_PER_RAD},
    ),
    "rflex": _spoken(
        dialects.DRIVES["rflex"].line,
        RflexEmulator,
        {"counts_per_m": emulated_rflex.COUNTS_PER_M, "counts_per_rad": emulated_rflex.COUNTS_PER_RAD},
    ),
}
_HEADS: Mapping[str, Callable[[HeadPlant], HostedBoard]] = {"dynamixel": DynamixelEmulator, "ptu": PtuEmulator}
PANTILTS: Mapping[str, Emulator[HeadPlant]] = {
    "board": Emulator(lambda plant, boot_id: PanTiltBoard(plant, boot_id=boot_id)),
    "fixed": Emulator(lambda plant, _: FixedEmulator(plant)),
    **{name: _spoken(dialects.PANTILTS[name].line, make) for name, make in _HEADS.items()},
}
_SENSORS: Mapping[str, Callable[[ScannerPlant], HostedBoard]] = {
    **{model.value: partial(TfminiEmulator, model=model) for model in Model},
    "dimetix": DimetixEmulator,
    "disto": DistoEmulator,
    "lw20": Lw20Emulator,
    "lwnx": LwnxEmulator,
    "scip": ScipEmulator,
}
RANGEFINDERS: Mapping[str, Emulator[ScannerPlant]] = {
    "board": Emulator(lambda plant, boot_id: RangefinderBoard(plant, boot_id=boot_id)),
    **{name: _spoken(dialects.RANGEFINDERS[name].line, make) for name, make in _SENSORS.items()},
}
OWN = "board"


class Firmware(enum.StrEnum):
    """What our own boards run."""

    PYTHON = "python"
    C = "c"


@dataclass(frozen=True, slots=True)
class Dialects:
    """What each emulated device speaks, and which firmware those run that speak our own protocol."""

    drive: str = OWN
    pantilt: str = OWN
    rangefinder: str = OWN
    boards: Firmware = Firmware.PYTHON

    def __post_init__(self) -> None:
        """Refuse a dialect that no emulator speaks, and firmware that is not there."""
        for device, table in (("drive", DRIVES), ("pantilt", PANTILTS), ("rangefinder", RANGEFINDERS)):
            dialect = getattr(self, device)
            if dialect not in table:
                raise ConfigError(f"no emulated {device} speaks {dialect!r}; known: {', '.join(table)}", key=device)
        if (self.pantilt == dialects.MOTORLESS) != (self.rangefinder in dialects.SCANNERS):
            scanners = ", ".join(dialects.SCANNERS)
            raise ConfigError(f"a head that is fixed and a scanner ({scanners}) need each other", key="pantilt")
        if self.boards is Firmware.C and firmware is None:
            raise ConfigError("there was no C compiler for the firmware when robotd was installed", key="boards")

    def drive_on(self, plant: DrivePlant, boot_id: int) -> HostedBoard:
        """Put a board on a base."""
        in_c = self.boards is Firmware.C and self.drive == OWN
        return (firmware.drive_board if in_c else DRIVES[self.drive].power_up)(plant, boot_id)

    def pantilt_on(self, plant: HeadPlant, boot_id: int) -> HostedBoard:
        """Put a board on a head."""
        in_c = self.boards is Firmware.C and self.pantilt == OWN
        return (firmware.pantilt_board if in_c else PANTILTS[self.pantilt].power_up)(plant, boot_id)

    def rangefinder_on(self, plant: ScannerPlant, boot_id: int) -> HostedBoard:
        """Put a board on a rangefinder."""
        in_c = self.boards is Firmware.C and self.rangefinder == OWN
        return (firmware.rangefinder_board if in_c else RANGEFINDERS[self.rangefinder].power_up)(plant, boot_id)

    def settings(self) -> dict[str, dict[str, object]]:
        """Return what the daemon's configuration must say of each device; what is the default is left out."""
        rows = {
            "drive": (self.drive, DRIVES[self.drive].settings),
            "pantilt": (self.pantilt, PANTILTS[self.pantilt].settings),
            "rangefinder": (self.rangefinder, RANGEFINDERS[self.rangefinder].settings),
        }
        return {
            device: {"dialect": dialect, **settings} if dialect != OWN else dict(settings)
            for device, (dialect, settings) in rows.items()
        }
