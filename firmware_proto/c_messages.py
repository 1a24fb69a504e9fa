"""The C of the messages: ``messages.h`` and ``messages.c``, from the same declarations as everything else.

Each message becomes a struct and two functions: one packs its payload, one unpacks a payload of exactly its size.
"""

import enum
import inspect
import re
from collections.abc import Iterator

from firmware_proto.dictionary import REQUEST_END, TELEMETRY_END, TELEMETRY_START
from firmware_proto.schema import REPLY, Message, Wire, payload_size, wire_fields

Enum = type[enum.IntEnum] | type[enum.IntFlag]

NOTICE = "/* Written by `python -m firmware_proto.generate` from the declarations beside this folder: edit those. */\n"
_C_TYPES = {"B": "uint8_t", "H": "uint16_t", "h": "int16_t", "I": "uint32_t", "i": "int32_t", "Q": "uint64_t"}
_BITS = {"B": 8, "H": 16, "h": 16, "I": 32, "i": 32, "Q": 64}


def header(messages: tuple[type[Message], ...], enums: list[Enum], numbers: dict[str, int]) -> str:
    """Return ``messages.h``.

    Args:
        messages: what is spoken.
        enums: the enumerations that fields name as their unit.
        numbers: other constants of the protocol, by name.
    """
    ranges = {
        "REPLY": REPLY,
        "REQUEST_END": REQUEST_END,
        "TELEMETRY_START": TELEMETRY_START,
        "TELEMETRY_END": TELEMETRY_END,
    }
    constants = "".join(f"#define BP_{name} {value}u\n" for name, value in (ranges | numbers).items())
    parts = [constants, *(_enum(one) for one in enums), *(_declared(message) for message in messages)]
    return (
        f"{NOTICE}#ifndef BP_MESSAGES_H\n#define BP_MESSAGES_H\n\n"
        "#include <stdbool.h>\n#include <stddef.h>\n#include <stdint.h>\n\n" + "\n".join(parts) + "\n#endif\n"
    )


def source(messages: tuple[type[Message], ...]) -> str:
    """Return ``messages.c``."""
    functions = [text for message in messages for text in _functions(message)]
    return f'{NOTICE}#include "messages.h"\n\n#include "little_endian.h"\n\n' + "\n".join(functions)


def c_name(name: str) -> str:
    """Return a name of Python's as C spells it.

    >>> c_name("SetVelocity")
    'set_velocity'
    """
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


def constant(name: str) -> str:
    """Return the name of a constant that belongs to a message or an enumeration."""
    return f"BP_{c_name(name).upper()}"


def comment(text: str) -> str:
    """Return a comment of one or more lines."""
    return f"/* {inspect.cleandoc(text).replace('``', '')} */"


def _enum(one: Enum) -> str:
    members = ",\n".join(
        f"    {constant(one.__name__)}_{name} = {int(member)}" for name, member in one.__members__.items()
    )
    return f"{comment(one.__doc__ or '')}\nenum bp_{c_name(one.__name__)} {{\n{members}\n}};\n"


def _declared(message: type[Message]) -> str:
    name, fields = constant(message.__name__), wire_fields(message)
    about = (
        f"{comment(message.__doc__ or '')}\n#define {name}_TYPE 0x{message.TYPE:02X}u\n"
        f"#define {name}_SIZE {payload_size(message)}u\n"
    )
    if not fields:
        return about
    members = "".join(f"    {_member(field, wire)}\n" for field, wire in fields.items())
    functions = "".join(f"{signature};\n" for signature in _signatures(message))
    return f"{about}\nstruct bp_{c_name(message.__name__)} {{\n{members}}};\n\n{functions}"


def _member(name: str, wire: Wire) -> str:
    declared = f"{_C_TYPES[wire.code]} {name};" if wire.code in _C_TYPES else f"uint8_t {name}[{wire.code[:-1]}];"
    unit = f"[{wire.unit}] " if wire.unit else ""
    return f"{declared} {comment(unit + wire.meaning)}"


def _signatures(message: type[Message]) -> tuple[str, str]:
    name, size = c_name(message.__name__), f"{constant(message.__name__)}_SIZE"
    return (
        f"void bp_pack_{name}(const struct bp_{name} *message, uint8_t payload[{size}])",
        f"bool bp_unpack_{name}(const uint8_t *payload, size_t size, struct bp_{name} *message)",
    )


def _functions(message: type[Message]) -> Iterator[str]:
    fields = wire_fields(message)
    if not fields:
        return
    pack, unpack = _signatures(message)
    lines = {name: _lines(name, wire, offset) for name, wire, offset in _placed(fields)}
    yield f"{pack}\n{{\n" + "".join(f"    {put}\n" for put, _ in lines.values()) + "}\n"
    # Exactly its size: a longer payload is of another version, whose first fields may mean something else.
    check = f"    if (size != {constant(message.__name__)}_SIZE)\n        return false;\n"
    yield f"{unpack}\n{{\n{check}" + "".join(f"    {get}\n" for _, get in lines.values()) + "    return true;\n}\n"


def _placed(fields: dict[str, Wire]) -> Iterator[tuple[str, Wire, int]]:
    offset = 0
    for name, wire in fields.items():
        yield name, wire, offset
        offset += _BITS[wire.code] // 8 if wire.code in _BITS else int(wire.code[:-1])


def _lines(name: str, wire: Wire, offset: int) -> tuple[str, str]:
    """Return the statements that pack and unpack one field."""
    at = f"payload + {offset}" if offset else "payload"
    if wire.code not in _BITS:
        size = wire.code[:-1]
        return f"bp_copy({at}, message->{name}, {size});", f"bp_copy(message->{name}, {at}, {size});"
    bits, signed = _BITS[wire.code], wire.code.islower()
    # Cast in the open: C's own conversion to unsigned is defined, but compilers warn, and readers wonder.
    value = f"(uint{bits}_t)message->{name}" if signed else f"message->{name}"
    read = f"bp_get_i{bits}({at})" if signed else f"bp_get_u{bits}({at})"
    return f"bp_put_u{bits}({at}, {value});", f"message->{name} = {read};"
