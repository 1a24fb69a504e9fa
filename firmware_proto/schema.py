"""How a message is declared: once, as a frozen dataclass whose fields say type, unit and meaning."""

import struct
from dataclasses import dataclass, fields
from functools import cache
from typing import Any, ClassVar, Self, get_type_hints

REPLY = 0x80
"""Added to a request's type for its reply."""


@dataclass(frozen=True, slots=True)
class Wire:
    """What one field is on the wire, as the metadata of an ``Annotated`` type."""

    code: str
    """Format character of :mod:`struct`, little-endian."""
    unit: str
    meaning: str


class Message:
    """Base of every message: fixed size, packed, little-endian."""

    TYPE: ClassVar[int]
    __slots__ = ()

    def to_payload(self) -> bytes:
        """Return the packed fields.

        Raises:
            struct.error: a value does not fit its field.
        """
        return _layout(type(self)).pack(*(getattr(self, field.name) for field in fields(self)))  # type: ignore[arg-type]  # every subclass is a dataclass

    @classmethod
    def from_payload(cls, payload: bytes) -> Self:
        """Return the message of a payload of exactly :func:`payload_size` bytes.

        Raises:
            struct.error: the payload has another size.
        """
        return cls(*_layout(cls).unpack(payload))  # type: ignore[arg-type]  # classes hash, instances need not


def wire_fields(message: type[Message]) -> dict[str, Wire]:
    """Return the wire metadata of each field, in wire order."""
    hints = get_type_hints(message, include_extras=True)
    return {field.name: _wire_of(hints[field.name]) for field in fields(message)}  # type: ignore[arg-type]  # every subclass is a dataclass


def _wire_of(annotation: Any) -> Wire:
    (wire,) = (item for item in annotation.__metadata__ if isinstance(item, Wire))
    return wire


@cache
def _layout(message: type) -> struct.Struct:
    # Little-endian and packed, whatever this machine is: microcontrollers read it in place.
    return struct.Struct("<" + "".join(wire.code for wire in wire_fields(message).values()))


def payload_size(message: type[Message]) -> int:
    """Return the exact payload size of a message [bytes]."""
    return _layout(message).size  # type: ignore[arg-type]  # classes hash, instances need not


def u8(unit: str, meaning: str) -> Wire:
    """Declare an unsigned 8-bit field."""
    return Wire("B", unit, meaning)


def u16(unit: str, meaning: str) -> Wire:
    """Declare an unsigned 16-bit field."""
    return Wire("H", unit, meaning)


def i16(unit: str, meaning: str) -> Wire:
    """Declare a signed 16-bit field."""
    return Wire("h", unit, meaning)


def u32(unit: str, meaning: str) -> Wire:
    """Declare an unsigned 32-bit field."""
    return Wire("I", unit, meaning)


def i32(unit: str, meaning: str) -> Wire:
    """Declare a signed 32-bit field."""
    return Wire("i", unit, meaning)


def u64(unit: str, meaning: str) -> Wire:
    """Declare an unsigned 64-bit field."""
    return Wire("Q", unit, meaning)


def raw(size: int, meaning: str) -> Wire:
    """Declare a field of exactly ``size`` bytes."""
    return Wire(f"{size}s", "bytes", meaning)
