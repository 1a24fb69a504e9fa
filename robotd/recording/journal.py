"""Where the daemon notes what happens: on the lines, from its clients, in its own computing."""

import asyncio
from abc import ABC, abstractmethod
from typing import Any

from robotd.core.clock import TurnCountingLoop
from robotd.hardware.link.tap import Direction
from robotd.recording.entries import (
    LINE_BROKE,
    BytesEntry,
    CauseEntry,
    CommandEntry,
    ComputedEntry,
    Entry,
    LineEntry,
    ResultEntry,
    TurnEntry,
    is_input,
)

TURNS_MAX = 50
"""What an input leads to at once takes fewer turns of the loop; what comes later than that meets no effect of it."""


class Journal(ABC):
    """Takes notes, and is a :class:`robotd.hardware.link.tap.Tap`. All times are monotonic [ns].

    An input that came before the effects of the last were over is noted with the turns of the loop between the two:
    a replay lets it come as early. That needs a loop that counts; on another every input seems to meet a loop at rest.
    """

    _input_turn: int | None = None
    """In which turn the last input came."""
    _asked_turn: int | None = None
    """In which turn something was first written to a line after that."""

    @abstractmethod
    def note(self, entry: Entry) -> None:
        """Take an entry. Does not block."""

    def bytes_passed(self, device: str, direction: Direction, time_ns: int, data: bytes) -> None:
        """Note bytes that were read from, or handed to, the line of ``device``."""
        # A copy, if it is a buffer that somebody fills again.
        self._note_in_turn(BytesEntry(time_ns, device, direction, bytes(data)))

    def line_changed(self, device: str, time_ns: int, *, up: bool) -> None:
        """Note that the line of ``device`` was opened or lost."""
        self._note_in_turn(LineEntry(time_ns, device, up))

    def line_broke(self, device: str, time_ns: int, reason: str) -> None:
        """Note how the line of ``device`` failed: what is told of it must be told again."""
        self.cause(time_ns, LINE_BROKE, {"device": device, "reason": reason})

    def command(self, time_ns: int, name: str, arguments: dict[str, Any]) -> None:
        """Note what a client asked for; ``arguments`` must fit into JSON."""
        self.asked(CommandEntry(time_ns, name, arguments))

    def asked(self, entry: CommandEntry) -> None:
        """Note what a client asked for, as an entry that was made already."""
        self._note_in_turn(entry)

    def computed(self, time_ns: int, name: str, index: int) -> None:
        """Note that the ``index``-th job called ``name`` was handed back to the loop."""
        self._note_in_turn(ComputedEntry(time_ns, name, index))

    def cause(self, time_ns: int, name: str, arguments: dict[str, Any]) -> None:
        """Note what is taken up now although no line, no client and no job brought it; ``arguments`` as in JSON."""
        self._note_in_turn(CauseEntry(time_ns, name, arguments))

    def result(self, time_ns: int, kind: str, content: dict[str, Any], digest: str) -> None:
        """Note a result; ``content`` must fit into JSON, ``digest`` stands for the whole of it."""
        self.note(ResultEntry(time_ns, kind, content, digest))

    def _note_in_turn(self, entry: Entry) -> None:
        loop = asyncio._get_running_loop()  # noqa: SLF001  # public for loops; the other raises where there is none
        if isinstance(loop, TurnCountingLoop):
            if is_input(entry):
                self._note_turns(entry, loop)
            # Only the first: how the answer comes depends on when it was asked, not on what was asked after it.
            elif isinstance(entry, BytesEntry) and self._asked_turn is None:
                self._asked_turn = loop.turn
        self.note(entry)

    def _note_turns(self, entry: Entry, loop: TurnCountingLoop) -> None:
        """Note how many turns ago the last input came, unless its effects are over.

        What was asked in between is answered later, however many turns that takes; only a stop is asked for in the
        same turn as it is noted, just before. All but bytes answer nothing: a client's wish, a stall, a silence come in
        their turn, whatever was asked.
        """
        before, self._input_turn = self._input_turn, loop.turn
        asked, self._asked_turn = self._asked_turn, None
        # A loop that rested since had nothing left to do: all effects were over, and the next input met none.
        if before is None or loop.rested_at > before:
            return
        if isinstance(entry, BytesEntry) and asked not in {None, loop.turn}:
            return
        if loop.turn - before <= TURNS_MAX:
            self.note(TurnEntry(entry.time_ns, loop.turn - before))
