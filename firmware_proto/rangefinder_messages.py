"""Messages of the laser rangefinder board: laser on and off, one shot."""

import enum
from dataclasses import dataclass
from typing import Annotated, ClassVar

from firmware_proto.schema import REPLY, Message, u8, u16, u32, u64


class ShotStatus(enum.IntEnum):
    """What became of a shot."""

    OK = 0
    """A distance was measured."""
    OVER_RANGE = 1
    """Nothing came back from within the instrument's reach."""
    TOO_NEAR = 2
    """Below the instrument's least distance."""
    WEAK = 3
    """Too little light came back."""
    SATURATED = 4
    """Too much light came back."""
    AMBIENT = 5
    """Other light drowned the answer."""
    NOT_MEASURED = 6
    """The instrument cannot see in this direction."""
    LASER_OFF = 7
    """The light was off, or went off before the answer came."""
    DEVICE_ERROR = 8
    """The instrument failed, or took longer than ``timeout_ms``."""


@dataclass(frozen=True, slots=True)
class SetLaser(Message):
    """Switch the laser. Only in ``CONFIGURED`` and ``ARMED``; Stop and Disarm switch it off."""

    TYPE: ClassVar[int] = 0x30
    on: Annotated[int, u8("bool", "1 on, 0 off.")]


@dataclass(frozen=True, slots=True)
class Shoot(Message):
    """Take one reading and answer with it."""

    TYPE: ClassVar[int] = 0x31
    timeout_ms: Annotated[int, u16("ms", "Longest time the measurement may take.")]


@dataclass(frozen=True, slots=True)
class Shot(Message):
    """One reading along the beam."""

    TYPE: ClassVar[int] = 0x31 | REPLY
    board_us: Annotated[int, u64("us", "When the light was sent, the board's time.")]
    range_mm: Annotated[int, u32("mm", "Distance along the beam; 0 unless the status is OK.")]
    strength: Annotated[int, u16("", "Signal strength, as the instrument counts it.")]
    status: Annotated[int, u8("ShotStatus", "What became of the shot.")]


MESSAGES: tuple[type[Message], ...] = (SetLaser, Shoot, Shot)
