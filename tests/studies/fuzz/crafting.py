"""From any bytes to a recording with right sums: they are a list of changes to a recording of a real session.

A line is a change: what to do (a byte), where (two bytes), and with what (the rest). No line, no change.
"""

import base64
import json
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

from tests.studies.fuzz.mcap_bytes import Container, mcap_bytes
from tests.studies.fuzz.session import Message, Session

_CHANGES_MAX = 12
_MESSAGES_MAX = 4000
_RUN_MAX = 64
_FILL_MAX_BITS = 20
_TIME_MAX_BITS = 63
_BOMB_BYTES = 64 * 1024 * 1024
_HOLE = "\N{REPLACEMENT CHARACTER}hole"
_TOPICS = ("command", "cause", "computed", "result", "turn", "line/drive", "serial/drive/from_board", "header", "new")


@dataclass(slots=True)
class _Draft:
    messages: list[Message]
    settings: tuple[str, ...]
    container: Container = field(default_factory=Container)

    def at(self, place: int) -> int:
        """Return which message is meant; those that are not bytes of a line are a few, so each other place is one."""
        few = [at for at, one in enumerate(self.messages) if not one.topic.startswith("serial/")]
        if place % 2 and few:
            return few[place // 2 % len(few)]
        return place // 2 % len(self.messages)


_Change = Callable[[_Draft, int, bytes], None]


def crafted(session: Session, script: bytes) -> bytes:
    """Return the recording of a session that is left after the changes."""
    draft = _Draft(list(session.messages), session.settings)
    for line in script.split(b"\n")[:_CHANGES_MAX]:
        if len(line) > 2 and draft.messages:
            (place,) = struct.unpack("<H", line[1:3])
            CHANGES[line[0] % len(CHANGES)](draft, place, line[3:])
            del draft.messages[_MESSAGES_MAX:]
    return mcap_bytes(draft.messages, draft.container)


def _first(material: bytes) -> int:
    return material[0] if material else 0


def _remove(draft: _Draft, place: int, material: bytes) -> None:
    at = draft.at(place)
    del draft.messages[at : at + 1 + _first(material) % _RUN_MAX]


def keep(draft: _Draft, place: int, material: bytes) -> None:
    """Let the recording end, or begin, somewhere."""
    at = draft.at(place)
    draft.messages = [draft.messages[0], *draft.messages[at:]] if _first(material) % 2 else draft.messages[: at + 1]


def double(draft: _Draft, place: int, material: bytes) -> None:
    at = draft.at(place)
    draft.messages[at:at] = [draft.messages[at]] * (1 << _first(material) % 8)


def _move(draft: _Draft, place: int, material: bytes) -> None:
    message = draft.messages.pop(draft.at(place))
    draft.messages.insert(int.from_bytes(material[:2], "little") % (len(draft.messages) + 1), message)


def _turn(draft: _Draft, place: int, material: bytes) -> None:
    """Let a run come in the other order."""
    at, length = draft.at(place), 2 + _first(material) % _RUN_MAX
    draft.messages[at : at + length] = draft.messages[at : at + length][::-1]


def _set_time(draft: _Draft, place: int, material: bytes) -> None:
    at = draft.at(place)
    message, bits = draft.messages[at], _first(material) % (2 * _TIME_MAX_BITS + 4)
    by_ns = (1 << bits // 2) * (-1 if bits % 2 else 1)
    draft.messages[at] = replace(message, time_ns=message.time_ns + by_ns)


def set_times(draft: _Draft, place: int, material: bytes) -> None:
    """Let all that follows come later."""
    at, by_ns = draft.at(place), 1 << _first(material) % _TIME_MAX_BITS
    draft.messages[at:] = [replace(one, time_ns=one.time_ns + by_ns) for one in draft.messages[at:]]


def _set_topic(draft: _Draft, place: int, material: bytes) -> None:
    at = draft.at(place)
    named = material[1:].decode("utf-8", errors="replace")
    topic = named or _TOPICS[_first(material) % len(_TOPICS)]
    draft.messages[at] = replace(draft.messages[at], topic=topic)


def _set_data(draft: _Draft, place: int, material: bytes) -> None:
    at = draft.at(place)
    draft.messages[at] = replace(draft.messages[at], data=material)


def splice(draft: _Draft, place: int, material: bytes) -> None:
    """Write over some bytes of a message."""
    at = draft.at(place)
    data = bytearray(draft.messages[at].data)
    start = int.from_bytes(material[:2], "little") % (len(data) + 1)
    data[start : start + len(material[2:])] = material[2:]
    draft.messages[at] = replace(draft.messages[at], data=bytes(data))


def _insert(draft: _Draft, place: int, material: bytes) -> None:
    """Add a message of another channel."""
    at = draft.at(place)
    topic = _TOPICS[_first(material) % len(_TOPICS)]
    draft.messages.insert(at, Message(topic, draft.messages[at].time_ns, material[1:]))


def set_value(draft: _Draft, place: int, material: bytes) -> None:
    """Put any JSON, or what is none, in the place of a value."""
    _put(draft, place, _first(material), material[1:].decode("utf-8", errors="replace"))


def _put(draft: _Draft, place: int, which: int, text: str) -> None:
    at = draft.at(place)
    message = draft.messages[at]
    try:
        document = json.loads(message.data)
    except (ValueError, RecursionError):
        return
    holders = list(_holders(document))
    if not holders:
        return
    holder, key = holders[which % len(holders)]
    holder[key] = _HOLE
    data = json.dumps(document).replace(json.dumps(_HOLE), text)
    draft.messages[at] = replace(message, data=data.encode("utf-8", errors="replace"))


def _holders(document: Any) -> Iterator[tuple[Any, Any]]:
    """Yield where each value of a document is: what holds it, and by what key."""
    left = [document]
    while left:
        holder = left.pop()
        keys = list(holder) if isinstance(holder, dict) else range(len(holder)) if isinstance(holder, list) else ()
        for key in keys:
            yield holder, key
            left.append(holder[key])


def _nest(draft: _Draft, place: int, material: bytes) -> None:
    """Put lists in lists in the place of a value."""
    depth = 1 << _first(material[1:]) % 17
    _put(draft, place, _first(material), "[" * depth + "]" * depth)


def _fill(draft: _Draft, place: int, material: bytes) -> None:
    """Put a long text in the place of a value."""
    length = 1 << _first(material[1:]) % (_FILL_MAX_BITS + 1)
    letter = json.dumps(chr(_first(material[2:])))[1:-1]
    _put(draft, place, _first(material), f'"{letter * length}"')


def _explode(draft: _Draft, place: int, material: bytes) -> None:
    """Put few letters that become many bytes in the place of a value."""
    _put(draft, place, _first(material), json.dumps(_bomb()))


@cache
def _bomb() -> str:
    packer = zlib.compressobj()
    pieces = [packer.compress(bytes(_BOMB_BYTES // 64)) for _ in range(64)]  # all at once would seem to be the replay's
    return base64.b64encode(b"".join((*pieces, packer.flush()))).decode()


def _add_key(draft: _Draft, place: int, material: bytes) -> None:
    at = draft.at(place)
    data = draft.messages[at].data
    key = json.dumps(material.decode("utf-8", errors="replace")).encode()
    draft.messages[at] = replace(draft.messages[at], data=data[:1] + key + b":null," + data[1:])


def _configure(draft: _Draft, place: int, material: bytes) -> None:
    """Set a line of the configuration."""
    try:
        header = json.loads(draft.messages[0].data)
        lines = header["config_text"].split("\n")
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return
    keys = [key for key, _, _ in (line.partition(" = ") for line in draft.settings) if not key.endswith("dir")]
    key = keys[place % len(keys)]
    others = (line for line in lines if not line.startswith(f"{key} = "))
    header["config_text"] = "\n".join((*others, f"{key} = {material.decode('utf-8', errors='replace')}"))
    draft.messages[0] = replace(draft.messages[0], data=json.dumps(header).encode())


def contain(draft: _Draft, place: int, material: bytes) -> None:
    """Change how the messages are put into the file."""
    container, text = draft.container, material[1:].decode("utf-8", errors="replace")
    match _first(material) % 8:
        case 0:
            container.chunk_messages = 1 + place % 999
        case 1:
            container.compression = text
        case 2:
            container.schema = text
        case 3:
            container.encoding = text
        case 4:
            container.profile = text
        case 5:
            container.missing.add(place)
        case 6:
            container.cut = place
        case _:
            container.spliced.append((place, material[1:]))


CHANGES: tuple[_Change, ...] = (
    _remove,
    keep,
    double,
    _move,
    _turn,
    _set_time,
    set_times,
    _set_topic,
    _set_data,
    splice,
    _insert,
    set_value,
    _nest,
    _fill,
    _explode,
    _add_key,
    _configure,
    contain,
)
"""What a line may do; which one its first byte says."""
