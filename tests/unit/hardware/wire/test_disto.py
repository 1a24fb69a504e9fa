"""The answers of the older dialect, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire.dimetix import DimetixWire, Distance, ErrorCode, Failed, Message, Ready, Value
from robotd.hardware.wire.disto import command, parsed

VECTORS: list[tuple[bytes, Message]] = [
    (b"31..06+00012345 51....+00000000\r\n", Distance(0, 12345)),
    (b"31..06+00012345\r\n", Distance(0, 12345)),
    (b"31..00+00001234 51....+00000000\r\n", Distance(0, 12340)),
    (b"31..08+00123454 51....+00000000\r\n", Distance(0, 12345)),
    (b"31..01+00012345 51....+00000000\r\n", Failed(0, ErrorCode.SYNTAX)),  # feet: not believed
    (b"40..06+00000253\r\n", Value(0, "40", 253)),
    (b"?\r\n", Ready(0)),
    (b"@E255\r\n", Failed(0, 255)),
]


@pytest.mark.parametrize(("data", "message"), VECTORS)
def test_each_answer_is_understood_whole_byte_by_byte_and_after_garbage(data: bytes, message: Message) -> None:
    assert DimetixWire(parsed).feed(data) == [message]
    wire = DimetixWire(parsed)
    assert [one for byte in data for one in wire.feed(bytes((byte,)))] == [message]
    wire = DimetixWire(parsed)
    assert wire.feed(b"\xff\x0031..06+0001\r\n" + data) == [message]
    assert wire.counters["bytes_skipped"] == 13


def test_commands_are_single_letters() -> None:
    assert [command(letter) for letter in "gop"] == [b"g\r\n", b"o\r\n", b"p\r\n"]


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_the_next_answer_is_understood(pieces: list[bytes]) -> None:
    wire = DimetixWire(parsed)
    for piece in pieces:
        wire.feed(piece)
    wire.feed(b"x" * 10_000 + b"\r")
    assert wire.feed(b"?\r\n") == [Ready(0)]
