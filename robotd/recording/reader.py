"""Reads a recording, whole or damaged: all entries before the first damage, and what the damage is.

Only chunks whose CRC is right are believed, and only as long as the count of their messages has no gap:
what comes out of a damaged file is an exact beginning of what went in.
"""

import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from mcap.exceptions import InvalidMagic, McapError
from mcap.records import Channel, Chunk, McapRecord, Message
from mcap.stream_reader import StreamReader, breakup_chunk

from robotd.core.errors import RecordingError
from robotd.recording.encoding import HEADER_TOPIC, decode, decode_header
from robotd.recording.entries import (
    CAUSES_ARE_NOTED,
    SILENCES_ARE_NOTED,
    BytesEntry,
    CauseEntry,
    Entry,
    LineEntry,
    RecordingHeader,
    ResultEntry,
)

_RECORD_LIMIT_BYTES = 64 * 1024 * 1024
_DAMAGE = (McapError, ValueError, OverflowError, struct.error)
"""What mcap raises for bytes that are none of its records, which it does not foresee everywhere."""


@dataclass(frozen=True, slots=True)
class Recording:
    """What a file held, up to its first damage."""

    header: RecordingHeader
    entries: tuple[Entry, ...]
    damage: str | None = None
    """Why the file cannot be read any further; None if it is whole."""

    @property
    def complete(self) -> bool:
        """Whether the file was read to its regular end."""
        return self.damage is None

    @property
    def end_ns(self) -> int:
        """Time of the last entry; of the start, if there is none."""
        return self.entries[-1].time_ns if self.entries else self.header.started_ns

    @property
    def notes_causes(self) -> bool:
        """Whether it holds what the daemon's own clocks and threads decided, as all do since 0.2."""
        return self._begun is not None

    @property
    def notes_silences(self) -> bool:
        """Whether each silence that fell is among them."""
        return self._begun is not None and self._begun.arguments.get(SILENCES_ARE_NOTED) is True

    @property
    def _begun(self) -> CauseEntry | None:
        first = self.entries[0] if self.entries else None
        return first if isinstance(first, CauseEntry) and first.name == CAUSES_ARE_NOTED else None

    @property
    def devices(self) -> tuple[str, ...]:
        """Names of the devices whose lines were recorded."""
        return tuple(sorted({entry.device for entry in self.entries if isinstance(entry, BytesEntry | LineEntry)}))

    @property
    def results(self) -> tuple[ResultEntry, ...]:
        """The results, in order."""
        return tuple(entry for entry in self.entries if isinstance(entry, ResultEntry))


def read(path: Path) -> Recording:
    """Read a recording as far as it is intact.

    Raises:
        RecordingError: there is no such file, it is no recording, or its damage leaves not even the header.
    """
    try:
        file = path.open("rb")
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {error.strerror}") from error
    with file:
        try:
            return _read_open(path, _BoundedFile(file))
        except OSError as error:
            raise RecordingError(f"cannot read {path}: {error.strerror}") from error


def _read_open(path: Path, file: "_BoundedFile") -> Recording:
    messages = _messages(file)
    try:
        topic, first = next(messages, ("", None))
    except InvalidMagic as error:
        raise RecordingError(f"{path} is not a recording: it does not begin as an MCAP file") from error
    except (*_DAMAGE, RecordingError) as error:
        raise RecordingError(f"{path} is damaged before its header ends: {_reason(error, file)}") from error
    if first is None or topic != HEADER_TOPIC:
        raise RecordingError(f"{path} is an MCAP file, but not a recording of robotd")
    header = decode_header(first.data)
    entries: list[Entry] = []
    damage = None
    try:
        for topic, message in messages:
            entry = decode(topic, message.log_time, message.data)
            if entry is not None:
                entries.append(entry)
    except (*_DAMAGE, RecordingError) as error:
        damage = f"{_reason(error, file)} after {len(entries)} entries, near byte {file.position}"
    return Recording(header, tuple(entries), damage)


def _messages(file: "_BoundedFile") -> Iterator[tuple[str, Message]]:
    """Yield the messages with their topics; at the first sign of damage raise one of ``_DAMAGE`` or RecordingError."""
    topics: dict[int, str] = {}
    read_count = 0
    for record in _records(file):
        if isinstance(record, Channel):
            topics[record.id] = record.topic
        elif isinstance(record, Message):
            # A chunk that is missing as a whole leaves no wrong checksum, only a gap in the count.
            if record.sequence != read_count or record.channel_id not in topics:
                raise RecordingError(f"message {read_count} is missing")
            read_count += 1
            yield topics[record.channel_id], record


def _records(file: "_BoundedFile") -> Iterator[McapRecord]:
    """Yield all records, those in chunks among them.

    Recordings are never compressed. What says that it is was made by another program, or is damage that could ask for
    any amount of memory.
    """
    for record in StreamReader(
        file,  # type: ignore[arg-type]  # it only calls read
        emit_chunks=True,
        validate_crcs=True,
        record_size_limit=_RECORD_LIMIT_BYTES,
    ).records:
        if not isinstance(record, Chunk):
            yield record
        elif record.compression:
            raise RecordingError(f"a chunk is compressed ({record.compression[:20]!r}), and recordings are not")
        else:
            yield from breakup_chunk(record, validate_crc=True)


def _reason(error: Exception, file: "_BoundedFile") -> str:
    return "the file is cut" if file.exhausted else str(error)


class _BoundedFile:
    """A file of which a damaged length field cannot ask for more memory than there are bytes."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._size = os.fstat(file.fileno()).st_size
        self.position = 0
        self.exhausted = False
        """Whether more was asked for than there is."""

    def read(self, size: int) -> bytes:
        data = self._file.read(min(size, self._size))  # a buffer for more would be made, though nothing fills it
        self.position += len(data)
        self.exhausted = len(data) < size
        return data
