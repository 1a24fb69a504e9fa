"""Entries as messages of an MCAP file, and back.

One channel per device and direction carries the raw bytes; everything else is JSON. The channel's name
says what a message is, its ``log_time`` is the monotonic time, and its ``sequence`` counts all messages
of the file, so that a lost chunk shows.
"""

import json
from dataclasses import asdict, fields, replace
from typing import Any, TypeVar

import msgspec

from robotd.core.errors import RecordingError
from robotd.hardware.link.tap import Direction
from robotd.recording.entries import (
    BytesEntry,
    CauseEntry,
    CommandEntry,
    ComputedEntry,
    Entry,
    LineEntry,
    RecordingHeader,
    ResultEntry,
    TurnEntry,
)

K = TypeVar(
    "K", bound=RecordingHeader | LineEntry | CommandEntry | ComputedEntry | CauseEntry | ResultEntry | TurnEntry
)
_TIME_MAX_NS = 2**63 - 1
"""What a clock of nanoseconds can show."""
PROFILE = "robotd"
HEADER_TOPIC = "header"
_SERIAL = "serial"
_LINE = "line"
_JSON_ENTRIES: dict[str, type[CommandEntry | ComputedEntry | CauseEntry | ResultEntry | TurnEntry]] = {
    "command": CommandEntry,
    "computed": ComputedEntry,
    "cause": CauseEntry,
    "result": ResultEntry,
    "turn": TurnEntry,
}
_NOT_SENT = {"time_ns", "encoded"}
"""The message has a time of its own, and does not hold itself."""
_TOPICS = {entry: topic for topic, entry in _JSON_ENTRIES.items()}


def encode_header(header: RecordingHeader) -> bytes:
    """Return the first message of a recording."""
    return _dumps(asdict(header))


def decode_header(data: bytes) -> RecordingHeader:
    """Return the header of a recording.

    Raises:
        RecordingError: the message is not one of ours.
    """
    try:
        header = _strictly(RecordingHeader, _loaded(data))
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        raise RecordingError(f"the header is not one of robotd's: {error}") from error
    if not 0 <= header.started_ns <= _TIME_MAX_NS:
        raise RecordingError(f"the header is not one of robotd's: it began at {header.started_ns} ns")
    return header


def encode(entry: Entry) -> tuple[str, bytes]:
    """Return the channel and the message of an entry.

    Raises:
        TypeError: a command or a result holds something that JSON cannot.
    """
    if isinstance(entry, BytesEntry):
        # Raw, without JSON around it: a damaged recording can still be read with any MCAP tool.
        return f"{_SERIAL}/{entry.device}/{entry.direction}", bytes(entry.data)
    if isinstance(entry, LineEntry):
        return f"{_LINE}/{entry.device}", _dumps({"up": entry.up})
    return _TOPICS[type(entry)], _message_of(entry)


E = TypeVar("E", bound=Entry)


def encoded(entry: E) -> E:
    """Return an entry that holds its message, so that :func:`encode` has nothing left to do, however often.

    Raises:
        TypeError: as :func:`encode`.
    """
    if isinstance(entry, CommandEntry | ResultEntry) and entry.encoded is None:
        return replace(entry, encoded=_message_of(entry))
    return entry


def _message_of(entry: CommandEntry | ComputedEntry | CauseEntry | ResultEntry | TurnEntry) -> bytes:
    made: bytes | None = getattr(entry, "encoded", None)
    names = (field.name for field in fields(entry) if field.name not in _NOT_SENT)
    return _dumps({name: getattr(entry, name) for name in names}) if made is None else made


def decode(topic: str, time_ns: int, data: bytes) -> Entry | None:
    """Return the entry of a message, or None on a channel that a later version may have added.

    Raises:
        RecordingError: the message does not fit its channel.
    """
    kind, _, rest = topic.partition("/")
    if not 0 <= time_ns <= _TIME_MAX_NS:
        raise RecordingError(f"a message on channel {topic[:80]} is of no time that a clock shows: {time_ns} ns")
    try:
        if kind == _SERIAL:
            device, _, direction = rest.rpartition("/")
            return BytesEntry(time_ns, device, Direction(direction), data)
        if kind == _LINE:
            return _converted(LineEntry, {"device": rest}, time_ns, data)
        if kind in _JSON_ENTRIES:
            return _converted(_JSON_ENTRIES[kind], {}, time_ns, data)
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        raise RecordingError(f"a message on channel {topic[:80]} is not one of robotd's: {error}") from error
    return None


def is_raw(topic: str) -> bool:
    """Whether a channel carries bytes as they are, and not JSON."""
    return topic.startswith(f"{_SERIAL}/")


def _converted(kind: type[K], given: dict[str, str], time_ns: int, data: bytes) -> K:
    content = _loaded(data)
    if not isinstance(content, dict):
        raise TypeError(f"expected an object, got {type(content).__name__}")
    return _strictly(kind, content | given | {"time_ns": time_ns})


def _loaded(data: bytes) -> Any:
    """Return a JSON document of which every text can be told.

    Raises:
        ValueError: it is none; RecursionError: too deep to read. JSON can name half a letter, and no file, digest or
            terminal takes one.
    """
    text = data.decode()
    content = json.loads(text)
    # Looked for first: to encode every document once more would double the time of reading.
    if "\\ud" in text or "\\uD" in text:
        json.dumps(content, ensure_ascii=False).encode()
    return content


def _strictly(kind: type[K], content: object) -> K:
    """Return a dataclass with fields of just these names and types.

    Raises:
        TypeError: there is a field too many.
        ValueError: one is missing, or of another type.
    """
    # Never from a file: it would be written again in place of what the entry says.
    names = {field.name for field in fields(kind)} - {"encoded"}
    if isinstance(content, dict) and not content.keys() <= names:
        raise TypeError(f"expected {', '.join(sorted(names))}, got {str(sorted(content.keys() - names))[:80]}")
    # Strict: a number that stands as text, or a true that stands for 1, was not written by us.
    return msgspec.convert(content, kind)


def _dumps(value: dict[str, Any]) -> bytes:
    return json.dumps(value, separators=(",", ":")).encode()
