"""Who answers on a line of which nothing is known: each dialect that may be asked, asked once.

For people who set up a robot. The daemon itself never guesses: it talks to what its configuration names.
"""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from dataclasses import dataclass

from robotd.hardware.devices.catalogue import SPEAKERS
from robotd.hardware.devices.dialects import DIALECTS
from robotd.hardware.transport.connector import connector
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.transport import Transport
from robotd.hardware.wire.enquiry import Enquiry

_ANSWER_S = 0.3


@dataclass(frozen=True, slots=True)
class Recognized:
    """A device that answered."""

    device: str
    """``drive``, ``pantilt`` or ``rangefinder``."""
    dialects: tuple[str, ...]
    """Those that fit the answer: more than one where a device does not say which it speaks."""
    said: str
    """What it said of itself."""


@dataclass(frozen=True, slots=True)
class _Asked:
    """One question to all dialects that ask it in the same way."""

    line_format: LineFormat
    data: bytes
    tries: int
    by: tuple[tuple[str, str, Enquiry], ...]
    """Device, dialect, question."""


async def found_on(port: str) -> Recognized | None:
    """Ask on a port who is there; see :func:`found_by`.

    Raises:
        TransportError: the port is not there, busy, or no serial port.
        ConfigError: it is no address.
    """
    return await found_by(lambda line_format: connector(port, line_format)())


async def found_by(open_line: Callable[[LineFormat], Awaitable[Transport]]) -> Recognized | None:
    """Ask, one dialect after the other, who is there; return who answered first, None if nobody did.

    Some seconds where nobody answers. Nothing is written that is for a device which may move of it.

    Args:
        open_line: opens the line, set as a dialect has it.
    """
    for asked in _questions():
        line = await open_line(asked.line_format)
        try:
            answers = await _answers(line, asked)
        finally:
            line.close()
        if answers:
            device = answers[0][0]
            return Recognized(device, tuple(dialect for its, dialect, _ in answers if its == device), answers[0][2])
    return None


def _questions() -> Iterator[_Asked]:
    """Yield each question once; that of our own boards comes first, for most robots have them."""
    together: dict[tuple[LineFormat, bytes], list[tuple[str, str, Enquiry]]] = {}
    for device, dialects in DIALECTS.items():
        for name, dialect in dialects.items():
            speech = SPEAKERS[device][name].speech
            if speech is not None and dialect.line is not None and isinstance(question := speech.enquiry, Enquiry):
                together.setdefault((dialect.line, question.data), []).append((device, name, question))
    # Who is known by what it sends unasked comes last: others may do so until they are asked.
    for (line_format, data), by in sorted(together.items(), key=lambda one: not one[0][1]):
        yield _Asked(line_format, data, by[0][2].tries, tuple(by))


async def _answers(line: Transport, asked: _Asked) -> list[tuple[str, str, str]]:
    """Return device, dialect and words of all that take what comes for an answer."""
    listeners = [(device, dialect, question, question.listener()) for device, dialect, question in asked.by]
    for _ in range(asked.tries):
        line.write(asked.data)
        try:
            async with asyncio.timeout(_ANSWER_S):
                while True:
                    piece = await line.read()
                    answers = [
                        (device, dialect, words)
                        for device, dialect, question, listener in listeners
                        for words in [next(filter(None, map(question.told, listener.feed(piece))), None)]
                        if words
                    ]
                    if answers:
                        return answers
        except TimeoutError:
            continue
    return []
