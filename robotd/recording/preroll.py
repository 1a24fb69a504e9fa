"""A journal that can be recorded from any moment on, and still from the beginning.

A replay must begin where the daemon began: with the handshakes, the maps in use, the commands. So the journal remembers
all of it, up to a bound for each source, and a recording that is started later gets what went before. Past a bound it
says that it cannot, rather than to record what no replay could use.
"""

import logging
from collections.abc import Callable, Sequence
from pathlib import Path

from robotd.core.errors import RecordingError
from robotd.recording.budget import Budgets, Source, source_of
from robotd.recording.encoding import encode, encoded
from robotd.recording.entries import Entry, RecordingHeader
from robotd.recording.journal import Journal
from robotd.recording.recorder import Recorder

_ENTRY_OVERHEAD_BYTES = 160
"""What an entry takes beside its message, roughly: a flood of tiny entries is a flood."""
_FORGOTTEN_AT_ONCE = 256

log = logging.getLogger(__name__)


class PrerollJournal(Journal):
    """Remembers what happened since the daemon started, and hands it to the recorder while there is one."""

    def __init__(self, header: RecordingHeader, limit_bytes: int) -> None:
        self.header = header
        self._limit_bytes = limit_bytes
        self._remembered: list[Entry] | None = []
        self._forgotten: list[Entry] = []
        """What is given back by and by: a hundred thousand entries at once would keep the loop."""
        self._budgets = Budgets(limit_bytes)
        self._exceeded: Source | None = None
        self._recorder: Recorder | None = None

    @property
    def remembered(self) -> Sequence[Entry]:
        """Everything since the start; nothing at all once that was too much."""
        return self._remembered or ()

    @property
    def path(self) -> Path | None:
        """The file being recorded to."""
        return self._recorder.path if self._recorder else None

    @property
    def error(self) -> str | None:
        """Why the recording under way ended by itself, if it did."""
        return self._recorder.error if self._recorder else None

    def note(self, entry: Entry) -> None:
        """Remember an entry, and record it; it is encoded once, unless it was before."""
        # Encoded before it is remembered: an object that changed since would be recorded as what it is by then.
        entry = encoded(entry)
        if self._recorder is not None:
            self._recorder.note(entry)
        if self._remembered is None:
            del self._forgotten[-_FORGOTTEN_AT_ONCE:]
            return
        self._remembered.append(entry)
        source = source_of(entry)
        if not self._budgets.use(source, _ENTRY_OVERHEAD_BYTES + len(encode(entry)[1])):
            # All of it goes: what lacks a piece no replay could use, and the memory is given back.
            self._forgotten, self._remembered, self._exceeded = self._remembered, None, source
            log.info("%s", self._why_not())

    def start(self, path: Path) -> None:
        """Begin to record, from the daemon's start on.

        Raises:
            RecordingError: one is under way, the file cannot be made, or the daemon has run for too long.
        """
        if self._recorder is not None:
            raise RecordingError(f"already recording to {self._recorder.path}")
        if self._remembered is None:
            raise RecordingError(self._why_not())
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RecordingError(f"cannot record to {path}: {error.strerror}") from error
        # A copy of the list: the recorder's thread writes it while this one goes on.
        self._recorder = Recorder(path, self.header, tuple(self._remembered))

    def _why_not(self) -> str:
        return (
            f"no recording can begin any more: {self._exceeded} have used up the pre-roll of {self._limit_bytes} bytes,"
            " and a recording must begin where the daemon began: restart it, or set recording.from_start = true"
        )

    def stop(self) -> Callable[[], None]:
        """End the recording; the returned function waits for the file and may block.

        Raises:
            RecordingError: nothing is being recorded, or it ended by itself before.
        """
        if self._recorder is None:
            raise RecordingError("nothing is being recorded")
        recorder, self._recorder = self._recorder, None

        def finish() -> None:
            recorder.close()
            if recorder.error is not None:
                raise RecordingError(f"{recorder.path} is incomplete: {recorder.error}")

        return finish
