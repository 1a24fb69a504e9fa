"""The ASCII dialect of the LightWare LW20 and SF20: bytes and messages.

A command is a type (``?`` reads, ``#`` sets), a channel and a parameter, perhaps a comma and a value, CR LF; the answer
is the name in lower case, perhaps a comma and an index, a colon and the value, in at most 32 characters. The very
first message after power-up is never answered, for it only tells the device that it is not on its other bus: so
something that nobody needs goes first (maker's guide to the serial line).
"""

import re
from dataclasses import dataclass

from robotd.hardware.wire.enquiry import Enquiry
from robotd.hardware.wire.receiving import Receiving
from robotd.hardware.wire.word import Word, typed

LINE_MAX_BYTES = 64
"""Answers have at most 32; what is longer without a line end is noise."""
_ANSWER = re.compile(r"([a-z]{1,8})(?:,(\d{1,3}))?:(.+)")
_NUMBER = re.compile(r"[+-]?\d{1,9}(?:\.\d{1,9})?")


@dataclass(frozen=True, slots=True)
class Lw20Answer:
    """``ldf,0:23.67``, ``lf:0`` or ``p:LW20,1.0,1.0``."""

    name: str
    index: int | None
    text: str

    @property
    def number(self) -> float | None:
        """The value, if it is one number."""
        return float(self.text) if _NUMBER.fullmatch(self.text) else None


def command(text: str) -> bytes:
    """Return a command with its line end."""
    return f"{text}\r\n".encode("ascii")


WAKE = command("www")
"""Never answered after power-up, and unknown later."""
_NAME = "?P"
PRODUCT = command(_NAME)
FIRST_RETURN_RAW = command("?LDF,1")
"""Index 0 is a median of the last few, 2 the closest and 3 the furthest of them."""
LASER_OFF, LASER_ON = command("#LF,0"), command("#LF,1")
PRODUCTS = ("LW20", "SF20")
"""How the names of those begin that are known."""
FASTEST = command("#LM,1")
"""388 measurements a second."""


class Lw20Wire(Receiving):
    """The receiving half."""

    def __init__(self) -> None:
        super().__init__("replies")

    def feed(self, data: bytes) -> list[Lw20Answer]:
        """Take bytes as they come; return the messages that are whole now."""
        messages: list[Lw20Answer] = []
        for byte in data:
            if byte in b"\r\n":
                messages += self._finish()
                continue
            self._begun.append(byte)
            if len(self._begun) > LINE_MAX_BYTES:
                self._skip()
        return messages

    def _finish(self) -> list[Lw20Answer]:
        found = _ANSWER.fullmatch(self._begun.decode("ascii", errors="replace").strip())
        if found is None:
            self._skip()
            return []
        self._begun.clear()
        self._counters["replies"] += 1
        return [Lw20Answer(found[1], None if found[2] is None else int(found[2]), found[3])]


ENQUIRY = Enquiry(
    WAKE + PRODUCT,
    Lw20Wire,
    lambda answer: answer.text if answer.name == "p" and answer.text.startswith(PRODUCTS) else None,
)
"""Its name; what comes first after power-up, also chooses that it speaks on this line."""


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the device ask for, in words: without its name, which is asked to see that it lives."""
    return typed(data, b"\r\n", left_out=(_NAME,))
