"""Messages of the pan/tilt board: aim, readback, limits, motion done."""

import enum
from dataclasses import dataclass
from typing import Annotated, ClassVar

from firmware_proto.schema import REPLY, Message, i32, u8, u16, u64


class Motion(enum.IntEnum):
    """What became of the newest Aim."""

    DONE = 0
    """Reached, and nothing stopped the head since."""
    TURNING = 1
    """Under way."""
    HALTED = 2
    """Not turning, and not there on its account: something stopped the head, or this session saw no Aim yet."""


@dataclass(frozen=True, slots=True)
class Aim(Message):
    """Turn the head; the newest wins and must be done within ``ttl_ms``. Only in ``ARMED``."""

    TYPE: ClassVar[int] = 0x20
    pan_tenth_mrad: Annotated[int, i32("0.1 mrad", "Pan, counter-clockwise from straight ahead.")]
    tilt_tenth_mrad: Annotated[int, i32("0.1 mrad", "Tilt, up from level.")]
    ttl_ms: Annotated[int, u16("ms", "A head still turning by then halts and latches DEADMAN.")]


@dataclass(frozen=True, slots=True)
class ReadAim(Message):
    """Ask where the head points."""

    TYPE: ClassVar[int] = 0x21


@dataclass(frozen=True, slots=True)
class AimReadback(Message):
    """Where the head points."""

    TYPE: ClassVar[int] = 0x21 | REPLY
    board_us: Annotated[int, u64("us", "The board's time.")]
    pan_tenth_mrad: Annotated[int, i32("0.1 mrad", "Measured pan.")]
    tilt_tenth_mrad: Annotated[int, i32("0.1 mrad", "Measured tilt.")]
    aim_seq: Annotated[int, u16("", "seq of the newest Aim.")]
    moving: Annotated[int, u8("Motion", "Whether it is there, turns, or was halted.")]


@dataclass(frozen=True, slots=True)
class ReadLimits(Message):
    """Ask for the mechanical limits."""

    TYPE: ClassVar[int] = 0x22


@dataclass(frozen=True, slots=True)
class Limits(Message):
    """The mechanical limits; a pan range of a full turn or more is endless."""

    TYPE: ClassVar[int] = 0x22 | REPLY
    pan_min_tenth_mrad: Annotated[int, i32("0.1 mrad", "Lowest pan.")]
    pan_max_tenth_mrad: Annotated[int, i32("0.1 mrad", "Highest pan.")]
    tilt_min_tenth_mrad: Annotated[int, i32("0.1 mrad", "Lowest tilt.")]
    tilt_max_tenth_mrad: Annotated[int, i32("0.1 mrad", "Highest tilt.")]


@dataclass(frozen=True, slots=True)
class AimReport(Message):
    """Periodic, and at once when a motion is done: where the head points."""

    TYPE: ClassVar[int] = 0xC4
    board_us: Annotated[int, u64("us", "The board's time.")]
    pan_tenth_mrad: Annotated[int, i32("0.1 mrad", "Measured pan.")]
    tilt_tenth_mrad: Annotated[int, i32("0.1 mrad", "Measured tilt.")]
    aim_seq: Annotated[int, u16("", "seq of the newest Aim.")]
    moving: Annotated[int, u8("Motion", "DONE with the aim_seq of an Aim is *motion done*.")]


MESSAGES: tuple[type[Message], ...] = (Aim, ReadAim, AimReadback, ReadLimits, Limits, AimReport)
