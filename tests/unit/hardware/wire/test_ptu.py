"""The vectors of the makers' documents, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire.ptu import Banner, Done, LimitHit, Message, PtuWire, Refused, command

VECTORS: list[tuple[bytes, list[Message]]] = [
    (b"FT *\r\n", [Done("")]),
    (b"*\r\n", [Done("")]),
    (b"*\r", [Done("")]),
    (b"ED *\r\n", [Done("")]),
    (b"* 185.142857\r\n", [Done("185.142857")]),
    (b"* -2500\r\n", [Done("-2500")]),
    (b"* Current Pan position is -2500\r\n", [Done("Current Pan position is -2500")]),
    (b"PP * 22\r\n", [Done("22")]),
    (b"! Maximum allowable Pan position is 3090\r\n", [Refused("Maximum allowable Pan position is 3090")]),
    (b"!T!T!P!P*\r\n", [LimitHit("T"), LimitHit("T"), LimitHit("P"), LimitHit("P"), Done("")]),
    (b"!T!T!P!P** 0\r\n", [LimitHit("T"), LimitHit("T"), LimitHit("P"), LimitHit("P"), Done(""), Done("0")]),
    (b"\n! Illegal Command Entered\r\n", [Refused("Illegal Command Entered")]),
    (b"!P", [LimitHit("P")]),
    (b"!P* 23\r\n", [LimitHit("P"), Done("23")]),
    (b"\n* 23.142857\r\n", [Done("23.142857")]),
    (b"PAN-TILT CONTROLLER v2.12\r\n", [Banner("PAN-TILT CONTROLLER v2.12")]),
]


@pytest.mark.parametrize(("data", "messages"), VECTORS)
def test_each_vector_is_understood_whole_byte_by_byte_and_after_garbage(data: bytes, messages: list[Message]) -> None:
    assert PtuWire().feed(data) == messages
    wire = PtuWire()
    assert [message for byte in data for message in wire.feed(bytes((byte,)))] == messages
    wire = PtuWire()
    assert wire.feed(b"\xff\x00\x80x\r" + data) == messages
    assert wire.counters["bytes_skipped"] == 4


def test_commands_are_letters_a_number_and_a_space() -> None:
    assert command("FT") == bytes.fromhex("46 54 20")
    assert command("PP", -2500) == bytes.fromhex("50 50 2D 32 35 30 30 20")
    assert command("PP", 3200) == bytes.fromhex("50 50 33 32 30 30 20")


@pytest.mark.parametrize(("text", "number"), [("-2500", -2500.0), ("", None), ("x is 31 pos/sec", 31.0), ("Ci", None)])
def test_the_number_of_an_answer_is_found_terse_or_verbose(text: str, number: float | None) -> None:
    assert Done(text).number == number


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_memory_is_bounded(pieces: list[bytes]) -> None:
    wire = PtuWire()
    for piece in pieces:
        wire.feed(piece)
    wire.feed(b"x" * 10_000)
    assert len(wire._begun) <= 256
    wire.feed(b"\r")
    assert wire.feed(b"* 1\r") == [Done("1")]
