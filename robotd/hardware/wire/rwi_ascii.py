"""The two-letter ASCII dialect of the RWI bases B12, B14 and B21: bytes and messages.

Commands are two characters and a hexadecimal argument, ended by CR. The base sends lines: answers ``TW 00001f40``,
status reports (``%PSR`` and a line for each item of the mask, in order), and events that begin with ``%``. There is no
checksum: an item of the wrong length makes its whole report worthless. A prompt ``*`` may stand before any line, and
until the base is told ``HD`` it echoes what it hears.
"""

import re
from dataclasses import dataclass

from robotd.hardware.wire.receiving import Receiving
from robotd.hardware.wire.word import Word, typed

LINE_MAX_BYTES = 64
"""What is longer without a line end is noise."""

TICKS_PER_S = 256
"""Of the base's clock: unit of the watchdog and of the report period."""
BUMPERS_NONE = 0xFFFF
"""The sixteen bump switches are active low."""

ITEMS = (
    *("SRD", "CLK", "GSF", "BBS", "BPX", "BPY", "TPH", "BRH", "TPE", "TVE", "TPW", "TSF", "TC0", "TC1", "TC2", "TC3"),
    *("RPE", "RVE", "RPW", "RSF", "RC0", "RC1", "RC2", "RC3", "A01", "A23", "A45", "A67", "RX1", "RX2", "RX3", "RX4"),
)
"""What a status report can hold, by bit of its mask."""

_ANSWER = re.compile(r"([A-Z]{2}) +([0-9A-Fa-f]{1,8})")
_ITEM = re.compile(r"([A-Z0-9]{3}) ([0-9A-Fa-f]{4}|[0-9A-Fa-f]{8})")
_EVENT = re.compile(r"%([A-Z]+)(?: ([0-9A-Fa-f]{1,8}))?(.*)")


@dataclass(frozen=True, slots=True)
class RwiAnswer:
    """The answer to a query."""

    mnemonic: str
    value: int


@dataclass(frozen=True, slots=True)
class Report:
    """A whole status report."""

    items: tuple[tuple[str, int], ...]


@dataclass(frozen=True, slots=True)
class RwiEvent:
    """What the base says by itself: ``BS`` bump switches, ``WDT`` watchdog, ``BLO`` battery low, ``TERR``..."""

    name: str
    value: int | None


Message = RwiAnswer | Report | RwiEvent


def command(mnemonic: str, argument: int | None = None) -> bytes:
    """Return a command; the argument is unsigned.

    Raises:
        ValueError: the argument does not fit into 32 bits.
    """
    # A query and a command without argument look alike: the mnemonic tells them apart.
    if argument is None:
        return f"{mnemonic}\r".encode("ascii")
    if not 0 <= argument <= 0xFFFFFFFF:
        raise ValueError(f"{mnemonic}: {argument} does not fit into 32 bits")
    return f"{mnemonic} {argument:x}\r".encode("ascii")


_ASKED, _HALTS = ("TW", "RW", "BV"), ("TH", "RH")
_RENEWED = re.compile(r"(?:WD|TV|RV) [0-9a-f]{1,8}")
"""A set-point is given again and again, at the machine's pace."""

STOP_BYTES = b"\r" + command("TH") + command("RH")
"""Both axes ramp down. The CR ends a command that was cut in half."""


class RwiWire(Receiving):
    """The receiving half."""

    def __init__(self, report_mask: int = 0) -> None:
        """Expect reports with the items of this mask."""
        self._expected = tuple(item for bit, item in enumerate(ITEMS) if report_mask & 1 << bit)
        super().__init__("answers", "reports", "events", "reports_damaged")
        self._items: list[tuple[str, int]] | None = None

    def feed(self, data: bytes) -> list[Message]:
        """Take bytes as they come; return the messages that are whole now."""
        messages: list[Message] = []
        for byte in data:
            if byte not in b"\r\n":
                self._begun.append(byte)
                if len(self._begun) > LINE_MAX_BYTES:
                    self._skip()
                continue
            message = self._finish()
            if message is not None:
                messages.append(message)
        return messages

    def reset(self) -> None:
        """Forget the beginning of a line, and of a report."""
        super().reset()
        self._items = None

    def _finish(self) -> Message | None:
        text = self._begun.decode("ascii", errors="replace").lstrip("*").strip()
        if not text:
            self._begun.clear()
            return None
        message = self._understood(text)
        # Echoes and greetings are text that means nothing, and no damage: they are not counted as skipped.
        if message is None and self._items is None and not text.isascii():
            self._skip()
        self._begun.clear()
        return message

    def _understood(self, text: str) -> Message | None:
        if text == "%PSR":
            self._drop_report()  # the rest of one under way will not come any more
            self._items = []
            return None
        if found := _EVENT.fullmatch(text.replace("%%", "%")):
            self._counters["events"] += 1
            return RwiEvent(found[1], None if found[2] is None else int(found[2], 16))
        if found := _ANSWER.fullmatch(text):
            self._counters["answers"] += 1
            return RwiAnswer(found[1], int(found[2], 16))
        return self._in_report(text)

    def _in_report(self, text: str) -> Report | None:
        """Take the next item of a report; one that is not the expected one spoils it."""
        if self._items is None:
            return None
        found = _ITEM.fullmatch(text)
        wanted = self._expected[len(self._items)] if len(self._items) < len(self._expected) else ""
        if found is None or found[1] != wanted or len(found[2]) != _digits(wanted):
            self._drop_report()
            return None
        self._items.append((wanted, int(found[2], 16)))
        if len(self._items) < len(self._expected):
            return None
        report, self._items = Report(tuple(self._items)), None
        self._counters["reports"] += 1
        return report

    def _drop_report(self) -> None:
        self._counters["reports_damaged"] += self._items is not None
        self._items = None


def _digits(item: str) -> int:
    return 8 if item == "CLK" else 4


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the base ask for, in words: without questions and set-points that come all the time."""
    said = typed(data, b"\r", left_out=_ASKED, until_obeyed=_HALTS)
    return [word for word in said if not _RENEWED.fullmatch(word.text)]
