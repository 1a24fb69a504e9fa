"""What bytes to a board ask for, in words: for the comparison of a replay with its recording."""

from firmware_proto.common import BoardKind, Ping
from firmware_proto.dictionary import messages_for
from firmware_proto.drive import SetVelocity
from firmware_proto.framing import Deframer, RawFrame
from firmware_proto.schema import Message, payload_size

_LEFT_OUT = (Ping, SetVelocity)
"""Sent again and again at a pace that depends on the machine, and harmless at any pace."""

KINDS = {kind.name.lower(): kind for kind in BoardKind}
"""Kind of board by the name of its device."""


def summarize_requests(device: str, data: bytes) -> list[str]:
    """Return a line for each request in bytes that were written to a device, without pings and velocity set-points."""
    by_type = {message.TYPE: message for message in messages_for(KINDS[device])}
    return [text for frame in Deframer().feed(data) if (text := _in_words(frame, by_type)) is not None]


def _in_words(frame: RawFrame, by_type: dict[int, type[Message]]) -> str | None:
    kind = by_type.get(frame.type)
    if kind is None or payload_size(kind) != len(frame.payload):
        return f"frame of type {frame.type:#04x} with {len(frame.payload)} bytes"
    if kind in _LEFT_OUT:
        return None
    return f"#{frame.seq} {kind.from_payload(frame.payload)}"
