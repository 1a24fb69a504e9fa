"""Frames on the wire: ``00 COBS(type u8 | flags u8 | seq u16 LE | payload | crc16 BE) 00``.

The zero byte cannot occur inside a packet, so a receiver finds the next frame whatever it heard before.
"""

import binascii
import struct
from dataclasses import dataclass

PAYLOAD_MAX = 240
"""Longest payload [bytes]."""
PACKET_MAX = 256
"""More bytes than this without a zero are noise."""

_HEADER = struct.Struct("<BBH")
_FRAME_MIN = _HEADER.size + 2
_FRAME_MAX = _HEADER.size + PAYLOAD_MAX + 2
_BLOCK = 255


@dataclass(frozen=True, slots=True)
class RawFrame:
    """One frame whose checksum was right (or will be made right)."""

    type: int
    seq: int
    payload: bytes


def crc16(data: bytes) -> int:
    """Return the CRC-16/IBM-3740 of ``data``; over a whole frame, its own checksum included, it is 0.

    >>> hex(crc16(b"123456789"))
    '0x29b1'
    """
    return binascii.crc_hqx(data, 0xFFFF)


def cobs_encode(data: bytes) -> bytes:
    """Return ``data``, at most 253 bytes, without its zeros and one byte longer.

    A run shorter than 254 bytes needs no code 255: each code is the distance to the next zero.

    >>> cobs_encode(bytes([7, 0, 0, 9])).hex(" ")
    '02 07 01 02 09'
    """
    if len(data) >= _BLOCK - 1:
        raise ValueError(f"{len(data)} bytes do not fit one COBS packet")
    return b"".join(bytes((len(run) + 1,)) + run for run in data.split(b"\0"))


def cobs_decode(packet: bytes) -> bytes | None:
    """Return what was encoded in a packet without zeros, or None if a code points past its end."""
    runs = []
    at = 0
    while at < len(packet):
        code = packet[at]
        runs.append(packet[at + 1 : at + code])
        if code < _BLOCK:
            runs.append(b"\0")
        at += code
    if at > len(packet):
        return None
    if runs and runs[-1] == b"\0":
        runs.pop()
    return b"".join(runs)


def encode_frame(frame: RawFrame) -> bytes:
    """Return the bytes on the wire; the leading zero flushes whatever noise came before.

    Raises:
        ValueError: the payload is longer than ``PAYLOAD_MAX``.
        struct.error: type or seq do not fit.
    """
    if len(frame.payload) > PAYLOAD_MAX:
        raise ValueError(f"payload of {len(frame.payload)} bytes is longer than {PAYLOAD_MAX}")
    body = _HEADER.pack(frame.type, 0, frame.seq) + frame.payload
    return b"\0" + cobs_encode(body + crc16(body).to_bytes(2, "big")) + b"\0"


class Deframer:
    """Finds frames in a stream of bytes. Damage is counted, never raised; memory is bounded."""

    def __init__(self) -> None:
        self.frames = 0
        """Good frames."""
        self.crc_errors = 0
        """Packets with a wrong checksum."""
        self.cobs_errors = 0
        """Packets that are no COBS."""
        self.length_errors = 0
        """Packets too short or too long for a frame, or with flags that version 1 does not know."""
        self._rest = b""

    def feed(self, data: bytes) -> list[RawFrame]:
        """Take bytes as they come and return the frames that they complete, in O(length)."""
        *packets, rest = (self._rest + data).split(b"\0")
        self._rest = rest[: PACKET_MAX + 1]  # one too many marks an overlong packet; what follows adds nothing
        decoded = (self._decode(packet) for packet in packets if packet)
        return [frame for frame in decoded if frame is not None]

    def _decode(self, packet: bytes) -> RawFrame | None:
        if len(packet) > PACKET_MAX:
            self.length_errors += 1
            return None
        body = cobs_decode(packet)
        if body is None:
            self.cobs_errors += 1
            return None
        if not _FRAME_MIN <= len(body) <= _FRAME_MAX:
            self.length_errors += 1
            return None
        return self._checked(body)

    def _checked(self, body: bytes) -> RawFrame | None:
        # Over the checksum as well, which then comes to 0: nothing has to be taken apart first.
        if crc16(body):
            self.crc_errors += 1
            return None
        kind, flags, seq = _HEADER.unpack_from(body)
        # Reserved by version 1: a frame that sets one means something that we would miss.
        if flags:
            self.length_errors += 1
            return None
        self.frames += 1
        return RawFrame(kind, seq, body[_HEADER.size : -2])
