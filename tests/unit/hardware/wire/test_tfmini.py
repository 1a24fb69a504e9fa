"""The vectors of the makers' documents, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire import tfmini
from robotd.hardware.wire.tfmini import Data, Message, Model, TfminiReply, TfminiVerdict, TfminiWire, command

VECTORS: list[tuple[str, Message]] = [
    ("5A 07 01 08 00 02 6C", TfminiReply(0x01, b"\x08\x00\x02")),
    ("59 59 7B 00 E8 03 C8 08 E8", Data(123, 1000)),
    ("59 59 FF FF 3C 00 C8 08 BC", Data(0xFFFF, 60)),
    ("59 59 FE FF FF FF C8 08 7D", Data(0xFFFE, 0xFFFF)),
    ("59 59 FC FF F4 01 C8 08 72", Data(0xFFFC, 500)),
    ("59 59 00 00 2A 00 C8 08 AC", Data(0, 42)),
    ("5A 05 11 00 70", TfminiReply(0x11, b"\0")),
    ("5A 05 11 00 6F", TfminiReply(0x11, b"\0")),
]


@pytest.mark.parametrize(("text", "message"), VECTORS)
def test_each_vector_is_understood_whole_byte_by_byte_and_after_garbage(text: str, message: Message) -> None:
    data = bytes.fromhex(text)
    assert TfminiWire().feed(data) == [message]
    wire = TfminiWire()
    assert [one for byte in data for one in wire.feed(bytes((byte,)))] == [message]
    assert message in TfminiWire().feed(b"\x00\x59\x59\x5a\x01" + data + bytes(9))


def test_a_frame_is_found_behind_one_that_only_looks_like_it() -> None:
    wire = TfminiWire()
    assert wire.feed(bytes.fromhex("59 59 59 7B 00 E8 03 C8 08 E8")) == [Data(123, 1000)]


@pytest.mark.parametrize(
    ("made", "text"),
    [
        (tfmini.TRIGGER, "5A 04 04 62"),
        (tfmini.RATE_0, "5A 06 03 00 00 63"),
        (command(0x03, b"\x64\x00"), "5A 06 03 64 00 C7"),
        (tfmini.VERSION, "5A 04 01 5F"),
        (tfmini.FORMAT_MM, "5A 05 05 06 6A"),
        (tfmini.FORMAT_CM, "5A 05 05 01 65"),
        (command(0x06, b"\x00\xc2\x01\x00"), "5A 08 06 00 C2 01 00 2B"),
        (tfmini.OUTPUT_OFF, "5A 05 07 00 66"),
        (tfmini.OUTPUT_ON, "5A 05 07 01 67"),
    ],
)
def test_commands_are_those_of_the_documents(made: bytes, text: str) -> None:
    assert made == bytes.fromhex(text)


@pytest.mark.parametrize(
    ("model", "distance", "strength", "verdict"),
    [
        (Model.TFMINI_S, 123, 1000, TfminiVerdict.OK),
        (Model.TFMINI_S, 0xFFFF, 60, TfminiVerdict.WEAK),
        (Model.TFMINI_S, 0xFFFE, 0xFFFF, TfminiVerdict.SATURATED),
        (Model.TFMINI_S, 0xFFFC, 500, TfminiVerdict.AMBIENT),
        (Model.TFMINI_S, 300, 100, TfminiVerdict.WEAK),
        (Model.TFMINI_PLUS, 0, 42, TfminiVerdict.WEAK),
        (Model.TFMINI_PLUS, 0, 0xFFFF, TfminiVerdict.SATURATED),
        (Model.TFMINI, 0xFFFF, 10, TfminiVerdict.WEAK),
        (Model.TFMINI, 1200, 500, TfminiVerdict.OUT_OF_RANGE),
        (Model.TF_LUNA, 55, 99, TfminiVerdict.WEAK),
        (Model.TF_LUNA, 55, 0xFFFF, TfminiVerdict.SATURATED),
    ],
)
def test_a_reading_is_judged_by_strength_and_then_by_the_sentinels_of_its_model(
    model: Model, distance: int, strength: int, verdict: TfminiVerdict
) -> None:
    assert Data(distance, strength).verdict(model) is verdict


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_memory_is_bounded(pieces: list[bytes]) -> None:
    wire = TfminiWire()
    for piece in pieces:
        wire.feed(piece)
    assert len(wire._begun) <= 32
    wire.feed(bytes(40))
    assert wire.feed(bytes.fromhex("59 59 7B 00 E8 03 C8 08 E8")) == [Data(123, 1000)]
