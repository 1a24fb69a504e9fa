"""What an emulated board puts on the wire: replies, which it remembers, and telemetry, which it counts."""

from collections import Counter

from firmware_proto.common import Ack, Nack, Result
from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.schema import REPLY, Message

_SEQ_SPAN = 1 << 16


class BoardOutbox:
    """Bytes for the host, and the memory that a session needs to repeat and to count them."""

    def __init__(self) -> None:
        self.telling = False
        """Whether telemetry goes out."""
        self._bytes = bytearray()
        self._remembered: dict[int, tuple[int, bytes]] = {}
        self._counters: Counter[int] = Counter()

    def new_session(self) -> None:
        """Forget what was answered, count from 0, and be silent until told otherwise."""
        self.telling = False
        self._remembered.clear()
        self._counters.clear()

    def take(self) -> bytes:
        """Return the bytes written since the last call."""
        taken = bytes(self._bytes)
        self._bytes.clear()
        return taken

    def tell(self, report: Message) -> None:
        """Send telemetry, if it goes out."""
        if not self.telling:
            return
        self._write(RawFrame(report.TYPE, self._counters[report.TYPE] % _SEQ_SPAN, report.to_payload()))
        self._counters[report.TYPE] += 1

    def reply(self, to_type: int, seq: int, outcome: Message | Result) -> bytes:
        """Answer a request with its own reply, with ``Ack`` (``OK``) or with NACK (any other result)."""
        if isinstance(outcome, Message):
            return self._write(RawFrame(outcome.TYPE, seq, outcome.to_payload()))
        if outcome is Result.OK:
            return self._write(RawFrame(to_type | REPLY, seq, Ack(outcome).to_payload()))
        return self._write(RawFrame(Nack.TYPE, seq, Nack(outcome, to_type).to_payload()))

    def repeat(self, to_type: int, seq: int) -> bool:
        """Answer a request as it was answered before, if it was the last of its type."""
        if to_type not in self._remembered:
            return False
        remembered_seq, wire = self._remembered[to_type]
        if seq == remembered_seq:
            self._bytes += wire
        return seq == remembered_seq

    def remember(self, to_type: int, seq: int, wire: bytes) -> None:
        """Keep an answer for :meth:`repeat`; empty while the answer is still to come."""
        self._remembered[to_type] = (seq, wire)

    def _write(self, frame: RawFrame) -> bytes:
        wire = encode_frame(frame)
        self._bytes += wire
        return wire
