"""A recorded conversation with one board, as the script that a fake board plays.

A script is a row of steps in recorded order. A *scripted request* is one that changed something; what follows one
was said because of it, and must wait for it. Questions that change nothing, renewed set-points and repeats are
not in the script: they are answered whenever they come.
"""

import zlib
from collections.abc import Iterator
from dataclasses import dataclass, replace

from firmware_proto.common import (
    PROTOCOL_MAJOR,
    PROTOCOL_MINOR,
    Arm,
    BoardKind,
    Clear,
    Configure,
    Disarm,
    Hello,
    HelloReply,
    Identify,
    IdentifyReply,
    Kill,
    Nack,
    Ping,
    Stop,
)
from firmware_proto.dictionary import TELEMETRY_END, TELEMETRY_START, answers_for, dictionary_for, requests_for
from firmware_proto.drive_messages import SetVelocity
from firmware_proto.framing import Deframer, RawFrame
from firmware_proto.pantilt_messages import Limits, ReadAim, ReadLimits
from firmware_proto.schema import REPLY, Message, payload_size
from robotd.hardware.link.tap import Direction
from robotd.recording.entries import BytesEntry, Entry, LineEntry

QUESTIONS = (Hello, Ping, Identify, ReadAim, ReadLimits)
"""They change nothing (Hello begins another script)."""
BOOKKEEPING = (Arm, Disarm, Clear, Stop, Kill)
"""What clients ask between missions: a script goes on without them if need be."""

_NS_PER_US = 1000


@dataclass(frozen=True, slots=True)
class ScriptedRequest:
    """A request of the recorded host: what follows waits for it."""

    time_us: int
    """When it was sent, the recorded host's clock."""
    request: Message
    seq: int
    answered: bool = False
    """Whether the script holds its answer."""


@dataclass(frozen=True, slots=True)
class Said:
    """A message of the recorded board."""

    time_us: int
    """When it arrived, the recorded host's clock."""
    message: Message
    answers: int | None = None
    """Which step it answers; None for telemetry."""


Step = ScriptedRequest | Said


@dataclass(frozen=True, slots=True)
class RecordedSession:
    """What was said from one Hello to the next."""

    hello: HelloReply | None
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Script:
    """All that a recording knows of one board."""

    kind: BoardKind
    sessions: tuple[RecordedSession, ...]
    """Those in which the board told something; at least one, which may be empty."""
    pieces: dict[int, bytes]
    """Pieces of its dictionary by offset."""
    limits: Limits | None

    def dictionary(self, session: int) -> bytes:
        """Return the recorded dictionary if it is whole, otherwise the one of this version."""
        hello = self.sessions[session].hello
        recorded = b"".join(data for _, data in sorted(self.pieces.items()))
        if hello is not None and zlib.crc32(recorded[: hello.dictionary_size]) == hello.dictionary_crc32:
            return recorded[: hello.dictionary_size]
        return dictionary_for(self.kind)

    def identity(self, session: int, nonce: int) -> HelloReply:
        """Return who the board was in a session, for another Hello."""
        dictionary = self.dictionary(session)
        size, crc = len(dictionary), zlib.crc32(dictionary)
        hello = self.sessions[session].hello
        if hello is None:
            return HelloReply(PROTOCOL_MAJOR, PROTOCOL_MINOR, nonce, size, crc, boot_id=1, clock_hz=1_000_000)
        return replace(hello, nonce=nonce, dictionary_size=size, dictionary_crc32=crc)


def read_script(entries: tuple[Entry, ...], device: str) -> Script:
    """Return the script of a device; a device that was not recorded has an empty one.

    Raises:
        KeyError: there is no such kind of board.
    """
    builder = _Builder(BoardKind[device.upper()])
    for entry in entries:
        if isinstance(entry, LineEntry) and entry.device == device:
            builder.line_changed()
        elif isinstance(entry, BytesEntry) and entry.device == device:
            builder.feed(entry)
    return builder.script()


def starts_motion(request: Message, *, moving: bool) -> bool:
    """Whether a request sets a base in motion that was told to stand."""
    return isinstance(request, SetVelocity) and not moving and not is_standstill(request)


def is_standstill(request: Message) -> bool:
    """Whether a request tells the base to stand, or takes from it the right to move."""
    if isinstance(request, SetVelocity):
        return not (request.speed_mmps or request.turn_mradps)
    return isinstance(request, (Configure, *BOOKKEEPING))


class _Builder:
    """Turns frames into steps."""

    def __init__(self, kind: BoardKind) -> None:
        self._kind = kind
        self._layouts = {Direction.TO_BOARD: requests_for(kind), Direction.FROM_BOARD: answers_for(kind)}
        self._deframers = {direction: Deframer() for direction in Direction}
        self._pieces: dict[int, bytes] = {}
        self._limits: Limits | None = None
        self._sessions: list[RecordedSession] = []
        self._nonce: int | None = None
        self._begin_session()

    def script(self) -> Script:
        self._end_session()
        sessions = self._sessions or [RecordedSession(None, ())]
        told = [replace(session, steps=_without_farewell(session.steps)) for session in sessions[:-1]]
        return Script(self._kind, (*told, sessions[-1]), self._pieces, self._limits)

    def line_changed(self) -> None:
        """Forget half a frame: its rest will not come."""
        self._deframers = {direction: Deframer() for direction in Direction}

    def feed(self, entry: BytesEntry) -> None:
        time_us = entry.time_ns // _NS_PER_US
        for frame in self._deframers[entry.direction].feed(entry.data):
            layout = self._layouts[entry.direction].get(frame.type)
            if layout is None or payload_size(layout) != len(frame.payload):
                continue
            message = layout.from_payload(frame.payload)
            if entry.direction is Direction.TO_BOARD:
                self._asked(time_us, message, frame.seq)
            else:
                self._said(time_us, message, frame)

    def _begin_session(self) -> None:
        self._hello: HelloReply | None = None
        self._steps: list[Step] = []
        self._by_seq: dict[tuple[int, int], int] = {}
        self._moving = False

    def _end_session(self) -> None:
        # One in which the board told nothing is a handshake that failed: there is nothing to play.
        if any(isinstance(step, Said) and step.answers is None for step in self._steps):
            self._sessions.append(RecordedSession(self._hello, tuple(self._steps)))
        self._begin_session()

    def _asked(self, time_us: int, request: Message, seq: int) -> None:
        if isinstance(request, Hello) and request.nonce != self._nonce:
            self._nonce = request.nonce
            self._end_session()
        if isinstance(request, QUESTIONS):
            return
        starts = starts_motion(request, moving=self._moving)
        if starts or is_standstill(request):
            self._moving = starts
        if isinstance(request, SetVelocity) and not starts:
            return
        if not self._is_repeat(request, seq):
            self._by_seq[request.TYPE, seq] = len(self._steps)
            self._steps.append(ScriptedRequest(time_us, request, seq))

    def _is_repeat(self, request: Message, seq: int) -> bool:
        if isinstance(request, Stop | Kill):  # all of them have the same seq, and they are sent in volleys
            last = next((step for step in reversed(self._steps) if isinstance(step, ScriptedRequest)), None)
            return last is not None and last.request == request
        return (request.TYPE, seq) in self._by_seq

    def _said(self, time_us: int, message: Message, frame: RawFrame) -> None:
        if isinstance(message, HelloReply):
            self._hello = message
        elif isinstance(message, IdentifyReply):
            self._pieces[message.offset] = message.data
        elif isinstance(message, Limits):
            self._limits = message
        elif TELEMETRY_START <= frame.type < TELEMETRY_END:
            if self._hello is not None or self._nonce is None:  # before HelloReply it belongs to the session before
                self._steps.append(Said(time_us, message))
        else:
            self._answered(time_us, message, frame)

    def _answered(self, time_us: int, message: Message, frame: RawFrame) -> None:
        of_type = message.of_type if isinstance(message, Nack) else frame.type - REPLY
        at = self._by_seq.get((of_type, frame.seq))
        if at is None:
            return  # the answer to a question, or to a set-point
        asked = self._steps[at]
        if (
            isinstance(asked, ScriptedRequest)
            and not asked.answered
            and not isinstance(asked.request, SetVelocity | Stop | Kill)
        ):
            self._steps[at] = replace(asked, answered=True)
            self._steps.append(Said(time_us, message, answers=at))


def _without_farewell(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    """Leave out the Stop with which a host ends a session that it gives up: nobody will ask for it again."""
    for at in range(len(steps) - 1, -1, -1):
        step = steps[at]
        if isinstance(step, ScriptedRequest):
            return steps[:at] if isinstance(step.request, Stop) else steps
    return steps


def asked_ahead(steps: tuple[Step, ...], at: int) -> Iterator[tuple[int, ScriptedRequest]]:
    """Yield the requests from step ``at`` on, with their places."""
    for place in range(at, len(steps)):
        step = steps[place]
        if isinstance(step, ScriptedRequest):
            yield place, step
