"""Messages that every board speaks: handshake, dictionary, clock, arming, stop, status."""

import enum
from dataclasses import dataclass
from typing import Annotated, ClassVar

from firmware_proto.schema import REPLY, Message, raw, u8, u16, u32, u64

PROTOCOL_MAJOR = 1
PROTOCOL_MINOR = 0
DICTIONARY_CHUNK = 64


class BoardKind(enum.IntEnum):
    """Which device a board drives; the dictionary names it."""

    DRIVE = 1
    """The synchro-drive base."""
    PANTILT = 2
    """The pan/tilt head."""
    RANGEFINDER = 3
    """The laser rangefinder."""


class BoardState(enum.IntEnum):
    """Life of a board: ``BOOT``, Hello, ``IDENTIFIED``, Configure, ``CONFIGURED``, Arm, ``ARMED``."""

    BOOT = 0
    """No session since power came."""
    IDENTIFIED = 1
    """A session is open; no telemetry yet."""
    CONFIGURED = 2
    """Everything but motion."""
    ARMED = 3
    """May move."""
    FAULT = 4
    """Latched: only Clear leads out, to ``CONFIGURED``."""


class Result(enum.IntEnum):
    """Outcome of a request, in its reply or in a NACK."""

    OK = 0
    """Done, or begun."""
    UNKNOWN_TYPE = 1
    """This board knows no such request."""
    BAD_LENGTH = 2
    """The payload has not the size of its type."""
    WRONG_STATE = 3
    """Not allowed in the present state."""
    BAD_VALUE = 4
    """A value is impossible; nothing was changed."""
    BUSY = 5
    """Still at work on the one before; ask again later."""


class Fault(enum.IntFlag):
    """Why a board is in ``FAULT``."""

    NONE = 0
    """All is well."""
    DEADMAN = 1
    """A motion outlived its ``ttl_ms``."""
    BUMPER = 2
    """A bumper was pressed while the base moved."""
    BATTERY = 4
    """Too low to move safely."""
    MOTOR = 8
    """A motor or its driver failed or stalled."""
    KILLED = 16
    """Kill was received."""


@dataclass(frozen=True, slots=True)
class Hello(Message):
    """Open a session; valid in every state. It disarms."""

    TYPE: ClassVar[int] = 0x01
    major: Annotated[int, u8("", "Protocol major version; a mismatch is refused by the host.")]
    minor: Annotated[int, u8("", "Protocol minor version.")]
    nonce: Annotated[int, u32("", "Chosen by the host, echoed, so that an old answer is not taken for this one.")]


@dataclass(frozen=True, slots=True)
class HelloReply(Message):
    """Identity of the board and of its boot."""

    TYPE: ClassVar[int] = 0x01 | REPLY
    major: Annotated[int, u8("", "Protocol major version of the board.")]
    minor: Annotated[int, u8("", "Protocol minor version of the board.")]
    nonce: Annotated[int, u32("", "The host's nonce.")]
    dictionary_size: Annotated[int, u16("bytes", "Size of the compressed dictionary.")]
    dictionary_crc32: Annotated[int, u32("", "CRC-32 of the compressed dictionary.")]
    boot_id: Annotated[int, u32("", "Changes at every boot; a change voids the session.")]
    clock_hz: Annotated[int, u32("Hz", "Ticks per second of the board's clock; times are sent in microseconds.")]


@dataclass(frozen=True, slots=True)
class Ping(Message):
    """Ask for the board's time."""

    TYPE: ClassVar[int] = 0x02
    host_us: Annotated[int, u64("us", "The host's monotonic time.")]


@dataclass(frozen=True, slots=True)
class Pong(Message):
    """The board's time beside the host's."""

    TYPE: ClassVar[int] = 0x02 | REPLY
    host_us: Annotated[int, u64("us", "The time in the Ping.")]
    board_us: Annotated[int, u64("us", "The board's time when the Ping arrived.")]


@dataclass(frozen=True, slots=True)
class Identify(Message):
    """Read a piece of the dictionary (zlib-compressed JSON)."""

    TYPE: ClassVar[int] = 0x03
    offset: Annotated[int, u16("bytes", "First byte wanted.")]


@dataclass(frozen=True, slots=True)
class IdentifyReply(Message):
    """A piece of the dictionary, padded with zeros after its end."""

    TYPE: ClassVar[int] = 0x03 | REPLY
    offset: Annotated[int, u16("bytes", "First byte given.")]
    data: Annotated[bytes, raw(DICTIONARY_CHUNK, "The bytes.")]


@dataclass(frozen=True, slots=True)
class Configure(Message):
    """Set what the session needs; leads to ``CONFIGURED``, disarmed."""

    TYPE: ClassVar[int] = 0x04
    telemetry_ms: Annotated[int, u16("ms", "Period of the periodic telemetry.")]
    ttl_max_ms: Annotated[int, u16("ms", "Longest ttl_ms that the board grants; longer ones are capped to it.")]


@dataclass(frozen=True, slots=True)
class ConfigureReply(Message):
    """What the board took over."""

    TYPE: ClassVar[int] = 0x04 | REPLY
    result: Annotated[int, u8("Result", "OK, or why not.")]
    config_crc32: Annotated[int, u32("", "CRC-32 of the Configure payload taken over.")]


@dataclass(frozen=True, slots=True)
class Arm(Message):
    """Allow motion; valid in ``CONFIGURED`` and ``ARMED``."""

    TYPE: ClassVar[int] = 0x05


@dataclass(frozen=True, slots=True)
class Disarm(Message):
    """Stop and forbid motion: ``ARMED`` goes back to ``CONFIGURED``."""

    TYPE: ClassVar[int] = 0x06


@dataclass(frozen=True, slots=True)
class Clear(Message):
    """Acknowledge a latched fault: ``FAULT`` goes to ``CONFIGURED``."""

    TYPE: ClassVar[int] = 0x07


@dataclass(frozen=True, slots=True)
class Stop(Message):
    """Ramp down and disarm. Accepted in every state, whatever the session."""

    TYPE: ClassVar[int] = 0x11


@dataclass(frozen=True, slots=True)
class Kill(Message):
    """Cut the motors at once and latch ``KILLED``. Accepted in every state, whatever the session."""

    TYPE: ClassVar[int] = 0x12


@dataclass(frozen=True, slots=True)
class BoardStatus(Message):
    """Periodic and on every change: state, fault, and what the board's receiver counted."""

    TYPE: ClassVar[int] = 0xC0
    board_us: Annotated[int, u64("us", "The board's time.")]
    state: Annotated[int, u8("BoardState", "Where in its life the board is.")]
    faults: Annotated[int, u16("Fault", "Latched faults.")]
    crc_errors: Annotated[int, u16("", "Packets refused by CRC, modulo 65536.")]
    cobs_errors: Annotated[int, u16("", "Packets refused by COBS, modulo 65536.")]
    length_errors: Annotated[int, u16("", "Packets or payloads of a wrong length, modulo 65536.")]


@dataclass(frozen=True, slots=True)
class Ack(Message):
    """Reply to every request that has no reply of its own; its type is the request's | 0x80."""

    TYPE: ClassVar[int] = REPLY
    result: Annotated[int, u8("Result", "OK, or why not.")]


@dataclass(frozen=True, slots=True)
class Nack(Message):
    """The request was not understood or not allowed; same seq as the request."""

    TYPE: ClassVar[int] = 0xFE
    code: Annotated[int, u8("Result", "Why.")]
    of_type: Annotated[int, u8("", "Type of the refused frame.")]


MESSAGES: tuple[type[Message], ...] = (
    Hello, HelloReply, Ping, Pong, Identify, IdentifyReply, Configure, ConfigureReply,
    Arm, Disarm, Clear, Stop, Kill, BoardStatus, Ack, Nack,
)  # fmt: skip
