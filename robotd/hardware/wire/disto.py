"""The older ASCII dialect of the Leica DISTO and Dimetix DLS-A distance sensors: bytes and messages.

Commands are single letters; only one device can be on the line. A measurement is answered by words of two digits that
say what it is, four characters about it, of which the last is the unit, a sign and eight digits:
``31..06+00012345 51....+00000000`` are 1.2345 m with no offset. The messages are those of the newer dialect, of a
device 0, so that one adapter serves both.

That 6 means tenths of a millimetre stands in the maker's example; that 0 means millimetres and 8 hundredths of one
comes from the format that these words belong to, GSI, and not from a document of this device. Other units are not
believed.
"""

import re

from robotd.hardware.wire.dimetix import DimetixWire, Distance, ErrorCode, Failed, Message, Ready, Value
from robotd.hardware.wire.enquiry import Enquiry
from robotd.hardware.wire.word import Word, typed

_DISTANCE_WORD = 31
_WORDS = re.compile(r"(?:\d\d[.\d]{4}[+-]\d{8} ?)+")
_WORD = re.compile(r"(\d\d)([.\d]{4})([+-]\d{8})")
_ERROR = re.compile(r"@E(\d{3})")
_TENTH_MM_IN = {"0": 10.0, "6": 1.0, "8": 0.1}
_ONLY_DEVICE = 0


def command(letter: str) -> bytes:
    """Return a command: ``g`` measures, ``o`` switches the light on and ``p`` off, ``t`` asks how hot it is."""
    return f"{letter}\r\n".encode("ascii")


def parsed(text: str) -> Message | None:
    """Return what a line says; None if it is none of theirs. For :class:`robotd.hardware.wire.dimetix.DimetixWire`."""
    if text == "?":
        return Ready(_ONLY_DEVICE)
    if found := _ERROR.fullmatch(text):
        return Failed(_ONLY_DEVICE, int(found[1]))
    if not _WORDS.fullmatch(text):
        return None
    index, about, number = _WORD.findall(text)[0]
    if int(index) != _DISTANCE_WORD:
        return Value(_ONLY_DEVICE, index, int(number))
    if about[-1] not in _TENTH_MM_IN:
        return Failed(_ONLY_DEVICE, ErrorCode.SYNTAX)
    return Distance(_ONLY_DEVICE, round(int(number) * _TENTH_MM_IN[about[-1]]))


ENQUIRY = Enquiry(
    command("t"),
    lambda: DimetixWire(parsed),
    lambda message: "it tells how hot it is" if isinstance(message, Value) else None,
)


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the device ask for, in words: without how hot it is, which is asked to see that it lives."""
    return typed(data, b"\r\n", left_out=("t",))
