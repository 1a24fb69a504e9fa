"""LWNX, the binary dialect of the LightWare LW20 and SF20: bytes and messages.

A packet is ``AA``, sixteen bits of flags, a number, data, and a CRC; the flags hold how many bytes number and data have
together, shifted by six, and whether it writes. Every request is answered by a packet of its number. No byte is
escaped: a packet is believed if its CRC fits, and else one byte is let go.
"""

import binascii
import struct
from dataclasses import dataclass

from robotd.hardware.wire.enquiry import Enquiry
from robotd.hardware.wire.lw20 import PRODUCTS
from robotd.hardware.wire.receiving import Receiving
from robotd.hardware.wire.word import Word, whole

_HEAD = 0xAA
_HEAD_BYTES, _CRC_BYTES = 3, 2
_LENGTH_SHIFT, _WRITE = 6, 1
PAYLOAD_MAX_BYTES = 32
"""The longest of those used has 17; a greater length is noise, or something that nobody asked for."""

NAME, DISTANCE_OUTPUT, STREAM, DISTANCE, LASER_FIRING, RATE = 0, 27, 30, 44, 50, 93
"""The numbers in use, of those in the maker's table."""
RAW_AND_STRENGTH = 1 << 0 | 1 << 4
"""Of the first return. There are a closest, a median and a furthest one, too, which are older by a few measurements."""
RATE_MAX = 8
"""388 measurements a second; the ASCII dialect counts the other way."""
_READING = struct.Struct("<hh")


@dataclass(frozen=True, slots=True)
class Packet:
    """One packet, of either side."""

    number: int
    data: bytes = b""
    writes: bool = False

    @property
    def reading(self) -> tuple[int, int] | None:
        """Distance [cm] and strength [%], if it is a distance with both, as was asked for."""
        if self.number != DISTANCE or len(self.data) != _READING.size:
            return None
        distance_cm, strength = _READING.unpack(self.data)
        return distance_cm, strength

    @property
    def text(self) -> str:
        """What it says, up to the first zero."""
        return self.data.partition(b"\0")[0].decode("ascii", errors="replace")


def encoded(packet: Packet) -> bytes:
    """Return the bytes of a packet."""
    flags = (1 + len(packet.data)) << _LENGTH_SHIFT | packet.writes * _WRITE
    head = bytes((_HEAD,)) + flags.to_bytes(2, "little") + bytes((packet.number,)) + packet.data
    return head + binascii.crc_hqx(head, 0).to_bytes(_CRC_BYTES, "little")


def read(number: int) -> bytes:
    """Return the request that reads."""
    return encoded(Packet(number))


def write(number: int, value: int, size: int) -> bytes:
    """Return the request that writes a value of this many bytes."""
    return encoded(Packet(number, value.to_bytes(size, "little"), writes=True))


class LwnxWire(Receiving):
    """The receiving half, of either side."""

    def __init__(self) -> None:
        super().__init__("packets", "crc_errors")

    def feed(self, data: bytes) -> list[Packet]:
        """Take bytes as they come; return the packets that are whole now."""
        packets: list[Packet] = []
        # A little at a time, so that the buffer stays bounded, whatever is poured in.
        for start in range(0, len(data), PAYLOAD_MAX_BYTES):
            self._begun += data[start : start + PAYLOAD_MAX_BYTES]
            packets += self._taken()
        return packets

    def _taken(self) -> list[Packet]:
        packets: list[Packet] = []
        while self._begun:
            size = self._size()
            if size > len(self._begun):
                break
            if size and binascii.crc_hqx(bytes(self._begun[: size - _CRC_BYTES]), 0) == self._crc(size):
                flags, number = self._begun[1], self._begun[_HEAD_BYTES]
                data = bytes(self._begun[_HEAD_BYTES + 1 : size - _CRC_BYTES])
                packets.append(Packet(number, data, writes=bool(flags & _WRITE)))
                self._counters["packets"] += 1
                del self._begun[:size]
            else:
                self._counters["crc_errors" if size else "bytes_skipped"] += 1
                del self._begun[:1]
        return packets

    def _size(self) -> int:
        """Return how long the packet is that may begin here: 0 if none can, and too long if that cannot be seen yet."""
        if self._begun[0] != _HEAD:
            return 0
        if len(self._begun) < _HEAD_BYTES:
            return len(self._begun) + 1
        payload = int.from_bytes(self._begun[1:_HEAD_BYTES], "little") >> _LENGTH_SHIFT
        return (_HEAD_BYTES + payload + _CRC_BYTES) if 1 <= payload <= PAYLOAD_MAX_BYTES else 0

    def _crc(self, size: int) -> int:
        return int.from_bytes(self._begun[size - _CRC_BYTES : size], "little")


ENQUIRY = Enquiry(
    read(NAME),
    LwnxWire,
    lambda packet: packet.text if packet.number == NAME and packet.text.startswith(PRODUCTS) else None,
)
"""Its name."""


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the device ask for, in words: without its name, which is asked to see that it lives."""
    return whole(data, ((encoded(packet), _word(packet)) for packet in LwnxWire().feed(data)))


def _word(packet: Packet) -> Word | None:
    if packet.number == NAME and not packet.writes:
        return None
    return Word(f"write {packet.number} {packet.data.hex(' ')}" if packet.writes else f"read {packet.number}")
