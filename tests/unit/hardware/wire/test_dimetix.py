"""The vectors of the maker's documents, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire.dimetix import DimetixWire, Distance, Failed, Message, Ready, Value, command

VECTORS: list[tuple[str, Message]] = [
    ("67 30 67 2B 30 30 30 31 32 33 34 35 0D 0A", Distance(0, 12345)),
    ("67 30 40 45 32 35 35 0D 0A", Failed(0, 255)),
    ("67 30 40 45 32 35 36 0D 0A", Failed(0, 256)),
    ("67 30 3F 0D 0A", Ready(0)),
    ("67 30 74 2B 30 30 30 30 30 32 35 33 0D 0A", Value(0, "t", 253)),
]


@pytest.mark.parametrize(("text", "message"), VECTORS)
def test_each_vector_is_understood_whole_byte_by_byte_and_after_garbage(text: str, message: Message) -> None:
    data = bytes.fromhex(text)
    assert DimetixWire().feed(data) == [message]
    wire = DimetixWire()
    assert [one for byte in data for one in wire.feed(bytes((byte,)))] == [message]
    wire = DimetixWire()
    assert wire.feed(b"\xff\x00g0g+12\r\n" + data) == [message]
    assert wire.counters["bytes_skipped"] == 8


def test_the_parity_bit_of_a_line_opened_with_eight_bits_is_masked() -> None:
    data = bytes(byte | 0x80 if byte.bit_count() % 2 else byte for byte in b"g0g+00012345\r\n")
    assert DimetixWire().feed(data) == [Distance(0, 12345)]


def test_commands_are_those_of_the_document() -> None:
    assert command(0, "g") == bytes.fromhex("73 30 67 0D 0A")
    assert command(0, "c") == bytes.fromhex("73 30 63 0D 0A")
    assert command(0, "o") == bytes.fromhex("73 30 6F 0D 0A")
    assert command(0, "t") == bytes.fromhex("73 30 74 0D 0A")


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_memory_is_bounded(pieces: list[bytes]) -> None:
    wire = DimetixWire()
    for piece in pieces:
        wire.feed(piece)
    wire.feed(b"x" * 10_000)
    assert len(wire._begun) <= 64
    wire.feed(b"\r")
    assert wire.feed(b"g0?\r\n") == [Ready(0)]
