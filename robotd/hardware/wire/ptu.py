"""The ASCII dialect of FLIR / Directed Perception pan/tilt units: PTU-46, D46, E46, D48E, D100E, D300.

Commands are letters, a number if one is set, and a space. Answers are ``*`` or ``* text`` on success and ``! text`` on
refusal; ``!P`` and ``!T`` come at any time, glued to whatever follows: an axis met its stop. After power-up the command
is echoed before the answer on its line. The answer to a reset may lack its line end, so a line may hold two answers.
"""

import re
from dataclasses import dataclass

from robotd.hardware.wire.receiving import Receiving
from robotd.hardware.wire.word import Word, typed

LINE_MAX_BYTES = 256
"""What is longer without a line end is noise."""

_NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?")
_ENDS = re.compile(rb"[\r\n]")


@dataclass(frozen=True, slots=True)
class Done:
    """``*``: the command was carried out, or the query answered."""

    text: str
    """What the query gave; empty for a command."""

    @property
    def number(self) -> float | None:
        """The first number of the answer, be it terse or verbose; None if it has none."""
        found = _NUMBER.search(self.text)
        return float(found[0]) if found else None


@dataclass(frozen=True, slots=True)
class Refused:
    """``!``: the command was not carried out."""

    text: str


@dataclass(frozen=True, slots=True)
class LimitHit:
    """``!P`` or ``!T``: an axis met its stop. With limits enforced, and no reset under way, steps were lost."""

    axis: str
    """``P`` or ``T``."""


@dataclass(frozen=True, slots=True)
class Banner:
    """Text that answers nothing: power-up, reset of the supply."""

    text: str


Message = Done | Refused | LimitHit | Banner


def command(letters: str, number: int | None = None) -> bytes:
    """Return a command, or without a number a query or a plain command.

    >>> command("PP", -2500)
    b'PP-2500 '
    """
    return f"{letters}{'' if number is None else number} ".encode("ascii")


STOP_BYTES = b" " + command("H")
"""Halts both axes. The space ends a command that was cut in half, so that the halt is not taken for its letters."""


class PtuWire(Receiving):
    """The receiving half."""

    def __init__(self) -> None:
        super().__init__("replies", "refusals", "limit_hits")

    def feed(self, data: bytes) -> list[Message]:
        """Take bytes as they come; return the messages that are whole now."""
        messages: list[Message] = []
        for byte in data:
            if _ENDS.match(bytes((byte,))):
                messages += self._finish()
                continue
            self._begun.append(byte)
            if bytes(self._begun[-2:]) in {b"!P", b"!T"}:
                messages += self._take_limits()
            elif len(self._begun) > LINE_MAX_BYTES:
                self._skip()
        return messages

    def _take_limits(self) -> list[Message]:
        """Take a limit mark out of the line at once: it ends no line, and the next may be long in coming."""
        axis = chr(self._begun[-1])
        del self._begun[-2:]
        self._counters["limit_hits"] += 1
        return [LimitHit(axis)]

    def _finish(self) -> list[Message]:
        # No checksum tells what was damaged, so a line with a byte that nobody types is no answer.
        if any(not 0x20 <= byte < 0x7F for byte in self._begun):
            self._skip()
            return []
        text = self._begun.decode("ascii")
        self._begun.clear()
        if "*" in text:
            answers = text.split("*")[1:]  # before the first stands the echo
            self._counters["replies"] += len(answers)
            return [Done(answer.strip()) for answer in answers]
        if "!" in text:
            self._counters["refusals"] += 1
            return [Refused(text.partition("!")[2].strip())]
        return [Banner(text.strip())] if text.strip() else []


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the unit ask for, in words: without the questions where it is."""
    return typed(data, b" ", left_out=("PP", "TP"), until_obeyed=("H",))
