"""The binary dialect of the Benewake TFmini family (TFmini, TFmini-S, TFmini Plus, TF-Luna): bytes and messages.

Data frames are ``59 59``, distance, strength, two more bytes and a sum; commands and their echoes ``5A``, length,
number, payload and a sum. ``59 59`` may stand inside a frame, so one is locked on only if its sum fits, and else one
byte is let go. Whether a reading can be believed is told by strength first, then by a sentinel that differs from model
to model.

The first generation of the TFmini says the same data frames, a hundred a second, and understands none of these
commands: its own begin with ``42 57``. Drivers of flight controllers send it only the choice of the format, and read
its stream, and so does ours.
"""

import enum
import struct
from dataclasses import dataclass

from robotd.hardware.wire.enquiry import Enquiry
from robotd.hardware.wire.receiving import Receiving
from robotd.hardware.wire.word import Word, whole

DATA_BYTES = 9
_DATA_HEAD, _COMMAND_HEAD = 0x59, 0x5A
_COMMAND_MIN, _COMMAND_MAX = 4, 32
_DATA = struct.Struct("<2xHH2sx")


class Model(enum.StrEnum):
    """Which one it is: they differ in how they say that nothing was measured."""

    TFMINI = "tfmini"
    TFMINI_S = "tfmini-s"
    TFMINI_PLUS = "tfmini-plus"
    TF_LUNA = "tf-luna"


class TfminiVerdict(enum.StrEnum):
    """What a data frame is worth."""

    OK = "ok"
    WEAK = "weak"
    SATURATED = "saturated"
    AMBIENT = "ambient"
    OUT_OF_RANGE = "out_of_range"


@dataclass(frozen=True, slots=True)
class Data:
    """One measurement, raw."""

    distance: int
    """Unsigned, in centimetres or as the unit was set."""
    strength: int

    def verdict(self, model: Model) -> TfminiVerdict:
        """Return what it is worth, coming from a model; strength first, then sentinels."""
        # The first generation says no such thing; its sentinels alone count.
        if self.strength == SATURATED_STRENGTH and model is not Model.TFMINI:
            return TfminiVerdict.SATURATED
        sentinel = _SENTINELS.get(self.distance) or _SENTINELS_OF_MODEL.get((model, self.distance), TfminiVerdict.OK)
        is_weak = self.strength < _WEAK_BELOW[model] and sentinel is not TfminiVerdict.AMBIENT
        return TfminiVerdict.WEAK if is_weak else sentinel


SATURATED_STRENGTH = 0xFFFF
_SENTINELS = {0xFFFF: TfminiVerdict.WEAK, 0xFFFE: TfminiVerdict.SATURATED, 0: TfminiVerdict.WEAK}
_SENTINELS_OF_MODEL = {
    (Model.TFMINI_S, 0xFFFC): TfminiVerdict.AMBIENT,
    (Model.TFMINI, 1200): TfminiVerdict.OUT_OF_RANGE,
}
_WEAK_BELOW = {Model.TFMINI: 20, Model.TFMINI_S: 101, Model.TFMINI_PLUS: 100, Model.TF_LUNA: 100}


@dataclass(frozen=True, slots=True)
class TfminiReply:
    """The answer to a command: an echo of it, a status, or the version."""

    number: int
    payload: bytes


Message = Data | TfminiReply


def command(number: int, payload: bytes = b"") -> bytes:
    """Return a command with its length and sum."""
    head = bytes((_COMMAND_HEAD, len(payload) + _COMMAND_MIN, number)) + payload
    return head + bytes((sum(head) & 0xFF,))


VERSION_NUMBER = 0x01
VERSION = command(VERSION_NUMBER)
TRIGGER = command(0x04)
RATE_0 = command(0x03, b"\0\0")
OUTPUT_OFF, OUTPUT_ON = command(0x07, b"\0"), command(0x07, b"\1")
FIRST_STANDARD = bytes.fromhex("42 57 02 00 00 00 01 02  42 57 02 00 00 00 01 06  42 57 02 00 00 00 00 02")
"""For a TFmini of the first generation, which understands nothing else: configure, say data frames, done."""
FORMAT_CM, FORMAT_MM = command(0x05, b"\1"), command(0x05, b"\6")


class TfminiWire(Receiving):
    """The receiving half."""

    def __init__(self) -> None:
        super().__init__("measurements", "replies", "sum_errors")

    def feed(self, data: bytes) -> list[Message]:
        """Take bytes as they come; return the messages that are whole now."""
        self._begun += data
        messages: list[Message] = []
        while (size := self._size()) <= len(self._begun) and self._begun:
            if size and self._sum_fits(size):
                messages.append(self._message(bytes(self._begun[:size])))
                del self._begun[:size]
            else:
                # One byte, not a frame: 59 59 may stand inside one, and the true beginning follows.
                self._counters["sum_errors" if size else "bytes_skipped"] += 1
                del self._begun[:1]
        return messages

    def _size(self) -> int:
        """Return how long the frame is that may begin here: 0 if none can, and too long if that cannot be seen yet."""
        undecided = len(self._begun) + 1
        head = self._begun[:2]
        if not head:
            return undecided
        if head[0] == _DATA_HEAD:
            return undecided if len(head) == 1 else DATA_BYTES * (head[1] == _DATA_HEAD)
        if head[0] == _COMMAND_HEAD:
            return undecided if len(head) == 1 else head[1] * (_COMMAND_MIN <= head[1] <= _COMMAND_MAX)
        return 0

    def _sum_fits(self, size: int) -> bool:
        total, said = sum(self._begun[: size - 1]) & 0xFF, self._begun[size - 1]
        if total == said:
            return True
        # The TFmini-S manual prints status replies whose sum is one too small; libraries keep the rule: both are taken.
        is_status = self._begun[0] == _COMMAND_HEAD and size == _COMMAND_MIN + 1 and self._begun[2] in {0x02, 0x11}
        return is_status and (said + 1) & 0xFF == total

    def _message(self, frame: bytes) -> Message:
        if frame[0] == _COMMAND_HEAD:
            self._counters["replies"] += 1
            return TfminiReply(frame[2], frame[3:-1])
        self._counters["measurements"] += 1
        distance, strength, _ = _DATA.unpack(frame)
        return Data(distance, strength)


def _version(message: Message) -> str | None:
    # An empty one is our own question, from a line that echoes.
    if not isinstance(message, TfminiReply) or message.number != VERSION_NUMBER or not message.payload:
        return None
    return f"version {'.'.join(map(str, reversed(message.payload)))}"


def _streams(message: Message) -> str | None:
    return "it streams readings" if isinstance(message, Data) else None


def enquiry_to(model: Model) -> Enquiry:
    """Return how one is found: by its version, for which model it is none of them says; the first hears nothing."""
    return Enquiry(b"", TfminiWire, _streams) if model is Model.TFMINI else Enquiry(VERSION, TfminiWire, _version)


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the device ask for, in words: without its version, which is asked to see that it lives."""
    # Its three orders are one request: none of them means anything alone.
    if data == FIRST_STANDARD:
        return [Word("first generation: say data frames")]
    replies = (message for message in TfminiWire().feed(data) if isinstance(message, TfminiReply))
    return whole(data, ((command(one.number, one.payload), _word(one)) for one in replies))


def _word(asked: TfminiReply) -> Word | None:
    """Return the word for a command, which looks like its echo."""
    frame = command(asked.number, asked.payload)
    return None if frame == VERSION else Word(f"command {asked.number:#04x} {asked.payload.hex(' ')}".rstrip())
