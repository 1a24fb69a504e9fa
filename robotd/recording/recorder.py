"""Writes everything that happens to an MCAP file, on a thread of its own.

The loop only appends to a bounded queue. The thread takes what is there once a second, or as soon as a
chunk is full, and ends the chunk: whatever kills the daemon, at most the last second is lost, and all
before it carries a CRC. Nothing is compressed: a recording must be readable when it is damaged.
"""

import logging
import os
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import IO

from mcap.writer import CompressionType, Writer

from robotd.core.errors import RecordingError
from robotd.core.precedence import no_realtime
from robotd.recording.budget import Budgets, source_of
from robotd.recording.encoding import HEADER_TOPIC, PROFILE, encode, encode_header, is_raw
from robotd.recording.entries import Entry, RecordingHeader
from robotd.recording.journal import Journal

FLUSH_S = 1.0
"""At most this much is lost, whatever ends the daemon."""
CHUNK_BYTES = 64 * 1024
_CHUNK_FILL = CHUNK_BYTES - 4096  # mcap ends a chunk with the message that exceeds this
_QUEUE_BYTES = 8 * 1024 * 1024
"""How far the disk may fall behind, for each source; beyond, the recording ends and the robot goes on."""
_ENTRY_OVERHEAD_BYTES = 128

_log = logging.getLogger(__name__)
_Message = tuple[str, int, bytes]


class Recorder(Journal):
    """Records until :meth:`close`, or until something goes wrong: then ``error`` says what, and the robot goes on."""

    def __init__(
        self, path: Path, header: RecordingHeader, earlier: Sequence[Entry] = (), *, queue_bytes: int = _QUEUE_BYTES
    ) -> None:
        """Begin a new file.

        Args:
            path: the file; it must not exist yet.
            header: what comes first.
            earlier: what happened before now; must not change any more. However long, it holds nobody up.
            queue_bytes: how far the disk may fall behind, for each source of entries.

        Raises:
            RecordingError: the file exists already, or cannot be made; or there is no thread left to write it.
        """
        self.path = path
        self.error: str | None = None
        self._queue: list[_Message] = []
        self._budgets = Budgets(queue_bytes)
        self._closing = False
        self._changed = threading.Condition()
        try:
            # x: a recording never takes the place of a file.
            file = path.open("xb")
        except OSError as error:
            raise RecordingError(f"cannot record to {path}: {error.strerror}") from error
        self._thread = threading.Thread(
            target=self._write_all, args=(file, header, earlier), name="recorder", daemon=True
        )
        try:
            self._thread.start()
        except RuntimeError as error:
            file.close()
            path.unlink()
            raise RecordingError(f"cannot record to {path}: {error}") from error

    def note(self, entry: Entry) -> None:
        """Queue an entry; after :meth:`close` or an error it is dropped.

        Raises:
            TypeError: a command or a result holds something that JSON cannot.
        """
        message = _message_of(entry)
        with self._changed:
            if self._closing:
                return
            self._queue.append(message)
            if not self._budgets.use(source_of(entry), len(message[2]) + _ENTRY_OVERHEAD_BYTES):
                self._fail(f"the disk does not keep up with {source_of(entry)}")
            # Not for each entry: the thread comes once a second by itself.
            if self._budgets.used_bytes > CHUNK_BYTES or self._closing:
                self._changed.notify()

    def close(self) -> None:
        """Write what is queued, end the file and wait for it. Blocks; closing twice is fine."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join()

    def _fail(self, reason: str) -> None:
        self.error = reason
        self._closing = True
        _log.error("recording to %s stopped: %s", self.path, reason)

    def _write_all(self, file: IO[bytes], header: RecordingHeader, earlier: Sequence[Entry]) -> None:
        no_realtime()
        try:
            with file:
                writer = _ChunkedFile(file)
                writer.write([(HEADER_TOPIC, header.started_ns, encode_header(header))])
                writer.write([_message_of(entry) for entry in earlier])
                closing = False
                while not closing:
                    messages, closing = self._take()
                    writer.write(messages)
                writer.finish()
        except Exception as error:  # a full disk, or a mistake: the recording says so, nobody waits for a dead thread
            with self._changed:
                self._fail(str(error) or repr(error))
                self._queue.clear()

    def _take(self) -> tuple[list[_Message], bool]:
        with self._changed:
            self._changed.wait_for(lambda: self._closing or self._budgets.used_bytes > CHUNK_BYTES, FLUSH_S)
            messages, self._queue = self._queue, []
            self._budgets.free()
            return messages, self._closing


def _message_of(entry: Entry) -> _Message:
    topic, data = encode(entry)
    return topic, entry.time_ns, data


class _ChunkedFile:
    """An MCAP file whose chunks end when we say so."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._channels: dict[str, int] = {}
        self._written = 0
        self._writer = Writer(
            file, chunk_size=_CHUNK_FILL, compression=CompressionType.NONE, enable_crcs=True, enable_data_crcs=True
        )
        self._writer.start(PROFILE)

    def write(self, messages: list[_Message]) -> None:
        """Write messages and end the chunk, down to the disk."""
        for topic, time_ns, data in messages:
            channel = self._channels.get(topic) or self._register(topic)
            self._writer.add_message(channel, time_ns, data, publish_time=time_ns, sequence=self._written)
            self._written += 1
        if messages:
            # A chunk for what there is, however little: what is not in a chunk with its checksum is not believed later.
            self._writer.flush()  # type: ignore[no-untyped-call]  # mcap leaves it bare
            os.fsync(self._file.fileno())

    def finish(self) -> None:
        """Write the summary."""
        self._writer.finish()  # type: ignore[no-untyped-call]  # mcap leaves it bare
        self._file.flush()
        os.fsync(self._file.fileno())

    def _register(self, topic: str) -> int:
        channel: int = self._writer.register_channel(topic, "" if is_raw(topic) else "json", schema_id=0)
        self._channels[topic] = channel
        return channel
