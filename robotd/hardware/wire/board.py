"""The dialect of our own boards, the host's side: bytes in, messages out. No loop, no clock.

Normative: ``firmware_proto/PROTOCOL.md``.
"""

import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass

from firmware_proto.common import PROTOCOL_MAJOR, PROTOCOL_MINOR, BoardKind, Hello, HelloReply, Ping, Stop
from firmware_proto.dictionary import TELEMETRY_END, TELEMETRY_START, answers_for, dictionary_for, requests_for
from firmware_proto.drive_messages import SetVelocity
from firmware_proto.framing import Deframer, RawFrame, encode_frame
from firmware_proto.schema import Message, payload_size
from robotd.core.errors import LocalProtocolError
from robotd.hardware.wire.enquiry import Enquiry
from robotd.hardware.wire.word import Repeat, Word, Words, whole

EMERGENCY_SEQ = 0xFFFF
"""``seq`` of the preformatted frames, so that their answers are not taken for those of a session's request."""

STOP_BYTES = encode_frame(RawFrame(Stop.TYPE, EMERGENCY_SEQ, b""))

_SEQ_SPAN = 1 << 16
_BOOTS_TRIES = 10
"""Opening the port resets some boards, and their boot loader must end first: about three seconds."""


@dataclass(frozen=True, slots=True)
class Received:
    """A message from a board."""

    type: int
    """As on the wire: tells which request an ``Ack`` answers (its type | 0x80)."""
    seq: int
    """The request's, in a reply; the counter of its type, in telemetry."""
    message: Message


@dataclass(frozen=True, slots=True)
class WireCounters:
    """What came over the line so far."""

    frames: int
    """Frames with a right checksum."""
    crc_errors: int
    cobs_errors: int
    length_errors: int
    """No frame at all, or the wrong size for its type."""
    unknown_types: int
    telemetry_gaps: int
    """Telemetry frames that never arrived."""


class BoardWire:
    """Reads and writes the bytes of one line to a board of one kind."""

    def __init__(self, kind: BoardKind) -> None:
        self._layouts = {code: (message, payload_size(message)) for code, message in answers_for(kind).items()}
        self._telemetry = [code for code in self._layouts if TELEMETRY_START <= code < TELEMETRY_END]
        self._deframer = Deframer()
        self._expected: dict[int, int] = {}
        self._wrong_sizes = 0
        self._unknown_types = 0
        self._gaps = 0

    @property
    def counters(self) -> WireCounters:
        """What came over the line so far."""
        return WireCounters(
            self._deframer.frames,
            self._deframer.crc_errors,
            self._deframer.cobs_errors,
            self._deframer.length_errors + self._wrong_sizes,
            self._unknown_types,
            self._gaps,
        )

    def encode(self, message: Message, seq: int) -> bytes:
        """Return the bytes of a request; ``seq`` counts modulo 65536.

        Raises:
            LocalProtocolError: a value does not fit its field.
        """
        try:
            return encode_frame(RawFrame(message.TYPE, seq % _SEQ_SPAN, message.to_payload()))
        except struct.error as error:
            raise LocalProtocolError(f"{message} does not fit the wire: {error}") from error

    def feed(self, data: bytes) -> list[Received]:
        """Take bytes as they come and return the messages that they complete; damage is only counted."""
        received = (self._received(frame) for frame in self._deframer.feed(data))
        return [one for one in received if one is not None]

    def _received(self, frame: RawFrame) -> Received | None:
        if frame.type not in self._layouts:
            self._unknown_types += 1
            return None
        message, size = self._layouts[frame.type]
        # A frame with a right checksum and a wrong size is another version of the contract, and never read in part.
        if len(frame.payload) != size:
            self._wrong_sizes += 1
            return None
        if message is HelloReply:
            self._expected = dict.fromkeys(self._telemetry, 0)  # each session counts from 0
        if frame.type in self._telemetry:
            self._count_gap(frame)
        return Received(frame.type, frame.seq, message.from_payload(frame.payload))

    def _count_gap(self, frame: RawFrame) -> None:
        # Before the first session that was seen to begin nothing is known to be missing.
        gap = (frame.seq - self._expected.get(frame.type, frame.seq)) % _SEQ_SPAN
        if gap < _SEQ_SPAN // 2:  # otherwise the counter went back: a repeat or a restart, nothing is lost
            self._gaps += gap
        self._expected[frame.type] = frame.seq + 1


def enquiry_to(kind: BoardKind) -> Enquiry:
    """Return how a board of this kind is found: by a HELLO, which leaves it disarmed; its dictionary tells the kind."""
    hello = Hello(PROTOCOL_MAJOR, PROTOCOL_MINOR, 0).to_payload()
    ours = zlib.crc32(dictionary_for(kind))

    def told(received: Received) -> str | None:
        message = received.message
        if not isinstance(message, HelloReply) or message.dictionary_crc32 != ours:
            return None
        return f"our {kind.name.lower()} board, protocol {message.major}.{message.minor}"

    return Enquiry(encode_frame(RawFrame(Hello.TYPE, 0, hello)), lambda: BoardWire(kind), told, _BOOTS_TRIES)


def requests_to(kind: BoardKind) -> Words:
    """Return what says what bytes to a board of a kind ask for: without pings and velocities, which are renewed."""
    layouts = requests_for(kind)

    def requests(data: bytes) -> list[Word]:
        return whole(data, ((encode_frame(frame), _word(frame, layouts)) for frame in Deframer().feed(data)))

    return requests


def _word(frame: RawFrame, layouts: Mapping[int, type[Message]]) -> Word | None:
    kind = layouts.get(frame.type)
    if kind is None or payload_size(kind) != len(frame.payload):
        return Word(f"frame of type {frame.type:#04x} with {len(frame.payload)} bytes")
    # Both go out at the pace of a loop: a slower machine would differ where nothing differed.
    if kind in (Ping, SetVelocity):
        return None
    repeat = Repeat.UNTIL_OBEYED if frame.seq == EMERGENCY_SEQ else Repeat.NUMBERED
    return Word(f"#{frame.seq} {kind.from_payload(frame.payload)}", repeat)
