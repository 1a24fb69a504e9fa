"""The vectors of the maker's documents, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire import lwnx
from robotd.hardware.wire.lwnx import LwnxWire, Packet, encoded, read, write

LW20 = b"LW20" + bytes(12)
VECTORS: list[tuple[str, Packet]] = [
    ("AA 40 00 00 70 9F", Packet(0)),
    ("AA 40 04 00 4C 57 32 30 00 00 00 00 00 00 00 00 00 00 00 00 1C CC", Packet(0, LW20)),
    ("AA 41 01 1B 14 00 00 00 4B 0E", Packet(27, b"\x14\0\0\0", writes=True)),
    ("AA 40 00 2C 9E 7A", Packet(44)),
    ("AA 40 01 2C D2 04 57 00 C5 02", Packet(44, b"\xd2\x04\x57\x00")),
    ("AA 81 00 32 00 B1 A4", Packet(50, b"\0", writes=True)),
    ("AA 81 00 32 01 90 B4", Packet(50, b"\1", writes=True)),
]
each_vector = pytest.mark.parametrize(("text", "packet"), VECTORS)


@each_vector
def test_each_vector_is_understood_whole_byte_by_byte_and_after_garbage(text: str, packet: Packet) -> None:
    data = bytes.fromhex(text)
    assert LwnxWire().feed(data) == [packet]
    wire = LwnxWire()
    assert [one for byte in data for one in wire.feed(bytes((byte,)))] == [packet]
    wire = LwnxWire()
    assert packet in wire.feed(b"\x00\xaa\x40\x01\x2c\x00\xaa" + data + bytes(40))
    assert wire.counters["bytes_skipped"] > 0


@each_vector
def test_each_vector_is_said_as_in_the_document(text: str, packet: Packet) -> None:
    assert encoded(packet) == bytes.fromhex(text)


def test_requests_are_those_of_the_document() -> None:
    assert read(lwnx.NAME) == bytes.fromhex("AA 40 00 00 70 9F")
    assert read(lwnx.DISTANCE) == bytes.fromhex("AA 40 00 2C 9E 7A")
    assert write(lwnx.DISTANCE_OUTPUT, 0x14, 4) == bytes.fromhex("AA 41 01 1B 14 00 00 00 4B 0E")
    assert write(lwnx.LASER_FIRING, 0, 1) == bytes.fromhex("AA 81 00 32 00 B1 A4")


def test_a_reading_is_a_distance_and_a_strength() -> None:
    assert Packet(44, b"\xd2\x04\x57\x00").reading == (1234, 87)
    assert Packet(44, b"\x9c\xff\x00\x00").reading == (-100, 0)
    assert Packet(44, b"\xd2\x04").reading is None
    assert Packet(45, b"\xd2\x04\x57\x00").reading is None
    assert Packet(0, LW20).text == "LW20"


@each_vector
def test_no_packet_with_a_flipped_bit_is_believed(text: str, packet: Packet) -> None:
    data = bytes.fromhex(text)
    for at in range(8 * len(data)):
        flipped = bytearray(data)
        flipped[at // 8] ^= 1 << at % 8
        assert LwnxWire().feed(bytes(flipped) + bytes(40)) == []
    assert LwnxWire().feed(data[:-1] + data + bytes(40)) == [packet]


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_memory_is_bounded(pieces: list[bytes]) -> None:
    wire = LwnxWire()
    for piece in pieces:
        wire.feed(piece)
    wire.feed(b"\xaa\x40\x04" * 5_000)
    assert len(wire._begun) <= lwnx.PAYLOAD_MAX_BYTES + 5
    wire.reset()
    assert wire.feed(read(0)) == [Packet(0)]
