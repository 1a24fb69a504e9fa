"""The vectors of the maker's documents, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire import lw20
from robotd.hardware.wire.lw20 import LINE_MAX_BYTES, Lw20Answer, Lw20Wire, command

VECTORS: list[tuple[str, Lw20Answer]] = [
    ("6C 64 66 2C 30 3A 32 33 2E 36 37 0D 0A", Lw20Answer("ldf", 0, "23.67")),
    ("6C 66 3A 30 0D 0A", Lw20Answer("lf", None, "0")),
    (b"p:LW20,1.0,1\r\n".hex(), Lw20Answer("p", None, "LW20,1.0,1")),
]


@pytest.mark.parametrize(("text", "message"), VECTORS)
def test_each_vector_is_understood_whole_byte_by_byte_and_after_garbage(text: str, message: Lw20Answer) -> None:
    data = bytes.fromhex(text)
    assert Lw20Wire().feed(data) == [message]
    wire = Lw20Wire()
    assert [one for byte in data for one in wire.feed(bytes((byte,)))] == [message]
    wire = Lw20Wire()
    assert wire.feed(b"\xff\x00ldf,0\r\n" + data) == [message]
    assert wire.counters == {"replies": 1, "bytes_skipped": 7}


def test_commands_are_those_of_the_document() -> None:
    assert bytes.fromhex("77 77 77 0D 0A") == lw20.WAKE
    assert bytes.fromhex("3F 4C 44 46 2C 30 0D 0A") == command("?LDF,0")
    assert bytes.fromhex("23 4C 46 2C 30 0D 0A") == lw20.LASER_OFF


@pytest.mark.parametrize(
    ("text", "number"),
    [("23.67", 23.67), ("-1.00", -1.0), ("0", 0.0), ("LW20,1.0", None), ("nan", None), ("1e9", None)],
)
def test_only_plain_numbers_are_numbers(text: str, number: float | None) -> None:
    assert Lw20Answer("ld", None, text).number == number


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_memory_is_bounded(pieces: list[bytes]) -> None:
    wire = Lw20Wire()
    for piece in pieces:
        wire.feed(piece)
    wire.feed(b"x" * 10_000)
    assert len(wire._begun) <= LINE_MAX_BYTES
    assert wire.feed(b"\rlf:1\n") == [Lw20Answer("lf", None, "1")]
