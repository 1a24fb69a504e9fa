"""Messages of the synchro-drive board: velocity set-points, wheel counts, bumpers, battery."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from firmware_proto.schema import Message, i16, i32, u16, u64

TTL_LIMIT_MS = 1000
"""A drive board never grants a longer ``ttl_ms``, whatever Configure allows."""


@dataclass(frozen=True, slots=True)
class SetVelocity(Message):
    """Velocity set-point; the newest wins and lives for ``ttl_ms``. Only in ``ARMED``."""

    TYPE: ClassVar[int] = 0x10
    speed_mmps: Annotated[int, i16("mm/s", "Translation along the heading.")]
    turn_mradps: Annotated[int, i16("mrad/s", "Rotation of the heading, counter-clockwise.")]
    ttl_ms: Annotated[
        int, u16("ms", "Without a newer set-point by then, a moving base ramps down and latches DEADMAN.")
    ]


@dataclass(frozen=True, slots=True)
class OdometryReport(Message):
    """Periodic: what the two encoders counted. Cumulative, so a lost report loses nothing."""

    TYPE: ClassVar[int] = 0xC1
    board_us: Annotated[int, u64("us", "When it was measured, the board's time.")]
    translate_counts: Annotated[int, i32("counts", "Translation encoder, wraps.")]
    rotate_counts: Annotated[int, i32("counts", "Rotation encoder, counter-clockwise, wraps.")]
    speed_mmps: Annotated[int, i16("mm/s", "Measured translation.")]
    turn_mradps: Annotated[int, i16("mrad/s", "Measured rotation.")]


@dataclass(frozen=True, slots=True)
class DriveReport(Message):
    """Periodic and on every change: battery and bumpers."""

    TYPE: ClassVar[int] = 0xC2
    board_us: Annotated[int, u64("us", "The board's time.")]
    battery_mv: Annotated[int, u16("mV", "Battery voltage.")]
    bumpers: Annotated[
        int, u16("bit set", "Pressed bumpers; bit i is centred at i * 22.5 degrees counter-clockwise of the heading.")
    ]


MESSAGES: tuple[type[Message], ...] = (SetVelocity, OdometryReport, DriveReport)
