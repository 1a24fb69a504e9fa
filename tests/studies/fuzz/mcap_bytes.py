"""MCAP files with right sums, made of any messages: the writer of robotd would refuse most of them."""

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field

from tests.studies.fuzz.session import Message

_MAGIC = b"\x89MCAP0\r\n"
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 1, 2, 3, 4, 5, 6, 15
_U64 = 2**64 - 1


@dataclass(slots=True)
class Container:
    """How messages are put into a file."""

    chunk_messages: int = 200
    compression: str = ""
    """What a chunk says of itself; it is never true."""
    schema: str = ""
    encoding: str = "json"
    profile: str = "robotd"
    spliced: list[tuple[int, bytes]] = field(default_factory=list)
    """Written over the records of the chunks, whose sums fit nonetheless: where, and what."""
    missing: set[int] = field(default_factory=set)
    """Counts that no message has."""
    cut: int = 0
    """How many bytes are missing at the end."""


def mcap_bytes(messages: Sequence[Message], container: Container) -> bytes:
    """Return a file."""
    topics = {topic: number for number, topic in enumerate(dict.fromkeys(one.topic for one in messages))}
    body = [_record(_HEADER, _text(container.profile) + _text("crafted"))]
    number = 0
    for at in range(0, len(messages), container.chunk_messages):
        records = [_channels(topics, container)] if at == 0 else []
        for message in messages[at : at + container.chunk_messages]:
            number += number in container.missing
            records.append(_message(message, topics[message.topic], number))
            number += 1
        body.append(_chunk(b"".join(records), container))
    data = _MAGIC + b"".join(body)
    end = _record(_DATA_END, struct.pack("<I", zlib.crc32(data)))
    return (data + end + _record(_FOOTER, struct.pack("<QQI", 0, 0, 0)) + _MAGIC)[: -container.cut or None]


def _channels(topics: dict[str, int], container: Container) -> bytes:
    schema = int(bool(container.schema))
    first = _record(_SCHEMA, struct.pack("<H", schema) + _text(container.schema) + _text("jsonschema") + _text("{}"))
    return first * schema + b"".join(
        _record(
            _CHANNEL,
            struct.pack("<HH", number & 0xFFFF, schema)
            + _text(topic)
            + _text(container.encoding)
            + struct.pack("<I", 0),
        )
        for topic, number in topics.items()
    )


def _message(message: Message, channel: int, number: int) -> bytes:
    time_ns = message.time_ns & _U64
    return _record(_MESSAGE, struct.pack("<HIQQ", channel & 0xFFFF, number, time_ns, time_ns) + message.data)


def _chunk(records: bytes, container: Container) -> bytes:
    content = bytearray(records)
    for place, data in container.spliced:
        at = place % max(len(content), 1)
        content[at : at + len(data)] = data
    sums = struct.pack("<QQQI", 0, 0, len(content), zlib.crc32(content))
    return _record(_CHUNK, sums + _text(container.compression) + struct.pack("<Q", len(content)) + content)


def _record(kind: int, content: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(content)) + content


def _text(text: str) -> bytes:
    data = text.encode("utf-8", errors="replace")
    return struct.pack("<I", len(data)) + data
