"""The ASCII dialect of Dimetix DLS-C, FLS-C and D-series distance sensors and of their kin: bytes and messages.

A command is ``s``, the number of the device, a letter, CR LF; the answer is ``g``, the number, and the same letter with
a signed number of eight digits, or ``?`` for done, or ``@E`` and three digits for an error. The line has seven data
bits, so an eighth is masked. One command starts one fresh measurement: that is all a point-and-shoot laser needs.
"""

import enum
import re
from collections.abc import Callable
from dataclasses import dataclass

from robotd.hardware.wire.enquiry import Enquiry
from robotd.hardware.wire.receiving import Receiving
from robotd.hardware.wire.word import Word, typed

LINE_MAX_BYTES = 64
"""What is longer without a line end is noise."""

_DISTANCE = re.compile(r"g(\d)g([+-]\d{8})")
_READY = re.compile(r"g(\d)\?")
_ERROR = re.compile(r"g(\d)@E(\d{3})")
_OTHER = re.compile(r"g(\d)([a-z]+)([+-]\d+)")


class ErrorCode(enum.IntEnum):
    """What can go wrong with a measurement. 255 and 256 stand in a maker's document, the others await one."""

    SYNTAX = 203
    TOO_HOT = 252
    TOO_COLD = 253
    BAD_SIGNAL = 254
    TOO_WEAK = 255
    TOO_STRONG = 256
    AMBIENT_LIGHT = 257


@dataclass(frozen=True, slots=True)
class Distance:
    """``g0g+00012345``."""

    device: int
    tenth_mm: int


@dataclass(frozen=True, slots=True)
class Ready:
    """``g0?``: done, or switched on."""

    device: int


@dataclass(frozen=True, slots=True)
class Failed:
    """``g0@E255``."""

    device: int
    code: int


@dataclass(frozen=True, slots=True)
class Value:
    """Any other answer: temperature ``g0t+00000253``, serial number, type."""

    device: int
    letters: str
    number: int


Message = Distance | Ready | Failed | Value


def command(device: int, letters: str) -> bytes:
    """Return a command: ``s0g`` measures, ``s0o`` switches the light on, ``s0c`` clears all, ``s0t`` asks how hot."""
    return f"s{device}{letters}\r\n".encode("ascii")


class DimetixWire(Receiving):
    """The receiving half, which an older dialect shares."""

    def __init__(self, parse: Callable[[str], Message | None] | None = None) -> None:
        """Begin; ``parse`` says what a line means, and None of one that means nothing."""
        self._parse = parse or parsed
        super().__init__("replies", "errors")

    def feed(self, data: bytes) -> list[Message]:
        """Take bytes as they come; return the messages that are whole now."""
        messages: list[Message] = []
        for byte in data:
            if byte & 0x7F in b"\r\n":
                messages += self._finish()
                continue
            # Lines are 7E1: where a port was opened with eight bits, the parity is the eighth.
            self._begun.append(byte & 0x7F)
            if len(self._begun) > LINE_MAX_BYTES:
                self._skip()
        return messages

    def _finish(self) -> list[Message]:
        text = self._begun.decode("ascii")
        message = self._parse(text)
        if message is None:
            self._skip()
            return []
        self._begun.clear()
        self._counters["errors" if isinstance(message, Failed) else "replies"] += 1
        return [message]


def parsed(text: str) -> Message | None:
    """Return what a line says; None if it is none of theirs."""
    if found := _DISTANCE.fullmatch(text):
        return Distance(int(found[1]), int(found[2]))
    if found := _READY.fullmatch(text):
        return Ready(int(found[1]))
    if found := _ERROR.fullmatch(text):
        return Failed(int(found[1]), int(found[2]))
    if found := _OTHER.fullmatch(text):
        return Value(int(found[1]), found[2], int(found[3]))
    return None


ENQUIRY = Enquiry(
    command(0, "t"),
    DimetixWire,
    lambda message: f"at {message.number / 10:g} degrees Celsius" if isinstance(message, Value) else None,
)
"""How hot it is: the light stays off. One whose switch is not at 0 does not hear it."""


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the devices ask for, in words: without how hot one is, asked to see that it lives."""
    return typed(data, b"\r\n", left_out=[f"s{device}t" for device in range(10)])
