"""What a board can say and understand, and the dictionary in which it says so itself.

The dictionary is zlib-compressed JSON that the board keeps in flash. A host reads it once per build,
compares it with what it needs, and refuses to arm a board that would misunderstand it.
"""

import enum
import json
import zlib
from collections.abc import Iterator
from typing import Any

from firmware_proto import common, drive_messages, pantilt_messages, rangefinder_messages
from firmware_proto.common import PROTOCOL_MAJOR, PROTOCOL_MINOR, Ack, BoardKind
from firmware_proto.schema import REPLY, Message, wire_fields

REQUEST_END = 0x40
"""Types below are requests of the host."""
TELEMETRY_START = 0xC0
TELEMETRY_END = 0xF0

_ENUMS: tuple[type[enum.IntEnum] | type[enum.IntFlag], ...] = (
    common.BoardKind,
    common.BoardState,
    common.Result,
    common.Fault,
    pantilt_messages.Motion,
    rangefinder_messages.ShotStatus,
)
_OF_KIND = {
    BoardKind.DRIVE: drive_messages.MESSAGES,
    BoardKind.PANTILT: pantilt_messages.MESSAGES,
    BoardKind.RANGEFINDER: rangefinder_messages.MESSAGES,
}
_SIZE_MAX = 256 * 1024


def messages_for(kind: BoardKind) -> tuple[type[Message], ...]:
    """Return every message that a board of this kind speaks, both ways."""
    return (*common.MESSAGES, *_OF_KIND[kind])


def requests_for(kind: BoardKind) -> dict[int, type[Message]]:
    """Return what the host may send to such a board, by type."""
    return {message.TYPE: message for message in messages_for(kind) if message.TYPE < REQUEST_END}


def answers_for(kind: BoardKind) -> dict[int, type[Message]]:
    """Return what such a board may send, by type; a request without a reply of its own is answered by ``Ack``."""
    # An answer of its own takes the place of the acknowledgement, hence the order of the two.
    acks: dict[int, type[Message]] = {request | REPLY: Ack for request in requests_for(kind)}
    own = {message.TYPE: message for message in messages_for(kind) if message.TYPE > REPLY}
    return acks | own


def dictionary_for(kind: BoardKind) -> bytes:
    """Return the compressed dictionary; the same bytes whenever the declarations are the same."""
    content = {
        "device": kind.name.lower(),
        "protocol": [PROTOCOL_MAJOR, PROTOCOL_MINOR],
        "messages": {message.__name__: _described(message) for message in messages_for(kind)},
        "enums": {one.__name__: {member.name: member.value for member in one} for one in enums_of(messages_for(kind))},
    }
    # As small as it goes: it lies in the flash of a microcontroller, and is read over its line.
    return zlib.compress(json.dumps(content, separators=(",", ":")).encode(), 9)


def enums_of(messages: tuple[type[Message], ...]) -> list[type[enum.IntEnum] | type[enum.IntFlag]]:
    """Return the enumerations that the fields of these messages name as their unit."""
    units = {wire.unit for message in messages for wire in wire_fields(message).values()}
    return [one for one in _ENUMS if one.__name__ in units]


def _described(message: type[Message]) -> dict[str, Any]:
    fields = [
        {"name": name, "code": wire.code, "unit": wire.unit, "meaning": wire.meaning}
        for name, wire in wire_fields(message).items()
    ]
    return {"type": message.TYPE, "fields": fields}


def parse_dictionary(data: bytes) -> dict[str, Any]:
    """Return the content of a board's dictionary.

    Raises:
        ValueError: damaged, too large, or not of the shape that :func:`dictionary_for` gives.
    """
    unpacker = zlib.decompressobj()
    try:
        # Bounded: a few bytes of zlib can ask for a gigabyte.
        text = unpacker.decompress(data, _SIZE_MAX)
        content = json.loads(text)
    except (zlib.error, ValueError, RecursionError) as error:
        raise ValueError(f"the dictionary is damaged: {error}") from error
    if not unpacker.eof or not _is_shaped(content):
        raise ValueError("the dictionary is cut off or not of the expected shape")
    return dict(content)


def _is_shaped(content: Any) -> bool:
    return (
        isinstance(content, dict)
        and isinstance(content.get("device"), str)
        and all(isinstance(content.get(part), dict) for part in ("messages", "enums"))
        and all(_is_shaped_message(message) for message in content["messages"].values())
        and all(isinstance(one, dict) for one in content["enums"].values())
    )


def _is_shaped_message(message: Any) -> bool:
    fields = message.get("fields") if isinstance(message, dict) else None
    return isinstance(fields, list) and all(isinstance(field, dict) for field in fields)


def missing_or_different(theirs: dict[str, Any], ours: dict[str, Any]) -> list[str]:
    """Say what the board lacks, or lays out otherwise, of what we need; empty if it will understand us.

    What it has beyond our needs, and the wording of meanings, do not matter.
    """
    return [
        *_device_difference(theirs, ours),
        *_message_differences(theirs["messages"], ours["messages"]),
        *_enum_differences(theirs["enums"], ours["enums"]),
    ]


def _device_difference(theirs: dict[str, Any], ours: dict[str, Any]) -> Iterator[str]:
    if theirs["device"] != ours["device"]:
        yield f"the board is a {theirs['device']}, not a {ours['device']}"


def _message_differences(theirs: dict[str, Any], ours: dict[str, Any]) -> Iterator[str]:
    for name, needed in ours.items():
        if name not in theirs:
            yield f"{name} is missing"
        elif theirs[name].get("type") != needed["type"]:
            yield f"{name} has type {theirs[name].get('type')}, not {needed['type']}"
        elif _layout(theirs[name]) != _layout(needed):
            yield f"{name} has fields ({_spelled(theirs[name])}), not ({_spelled(needed)})"


def _layout(message: dict[str, Any]) -> list[tuple[Any, ...]]:
    return [(field.get("name"), field.get("code"), field.get("unit")) for field in message["fields"]]


def _spelled(message: dict[str, Any]) -> str:
    return ", ".join(f"{name}:{code} {unit}".rstrip() for name, code, unit in _layout(message))


def _enum_differences(theirs: dict[str, Any], ours: dict[str, Any]) -> Iterator[str]:
    for name, members in ours.items():
        for member, value in members.items():
            # By value, member by member: what the board has beyond ours does no harm.
            if theirs.get(name, {}).get(member) != value:
                yield f"{name}.{member} is {theirs.get(name, {}).get(member, 'missing')}, not {value}"
