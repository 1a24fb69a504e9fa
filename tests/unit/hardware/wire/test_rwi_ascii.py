"""The vectors of the documents, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire.rwi_ascii import Message, Report, RwiAnswer, RwiEvent, RwiWire, command

MASK = 0xE0EF0
REPORT = (
    b"%PSR\r\nBPX 8010\r\nBPY 7FF0\r\nTPH 0100\r\nBRH 0120\r\nTVE 1FFE\r\nTPW 0040\r\nTSF 4000\r\n"
    b"RVE 0000\r\nRPW 0000\r\nRSF 0000\r\n"
)
ITEMS = Report(
    (
        *(("BPX", 0x8010), ("BPY", 0x7FF0), ("TPH", 0x100), ("BRH", 0x120), ("TVE", 0x1FFE), ("TPW", 0x40)),
        *(("TSF", 0x4000), ("RVE", 0), ("RPW", 0), ("RSF", 0)),
    )
)
VECTORS: list[tuple[bytes, list[Message]]] = [
    (b"BV 1E0\r\n", [RwiAnswer("BV", 480)]),
    (b"*BV 1e0\r", [RwiAnswer("BV", 480)]),
    (b"RW 80000200\r\n", [RwiAnswer("RW", 0x80000200)]),
    (b"TW     1f\r\n", [RwiAnswer("TW", 0x1F)]),
    (REPORT, [ITEMS]),
    (REPORT.replace(b"TVE 1FFE", b"TVE 1FF"), []),
    (b"%BS FFFB\r\n", [RwiEvent("BS", 0xFFFB)]),
    (b"%WDT motors stopped\r\n", [RwiEvent("WDT", None)]),
    (b"%%WDT motors stopped\r\n", [RwiEvent("WDT", None)]),
    (b"%BHI\r\n", [RwiEvent("BHI", None)]),
]


@pytest.mark.parametrize(("data", "messages"), VECTORS)
def test_each_vector_is_understood_whole_byte_by_byte_and_after_garbage(data: bytes, messages: list[Message]) -> None:
    assert RwiWire(MASK).feed(data) == messages
    wire = RwiWire(MASK)
    assert [message for byte in data for message in wire.feed(bytes((byte,)))] == messages
    assert RwiWire(MASK).feed(b"\xff\x00%PSR\r\nBPX 8\r\n" + data) == messages


def test_an_event_in_the_middle_of_a_report_does_not_spoil_it() -> None:
    spoken = REPORT.replace(b"TPH", b"%BS FFFB\r\nTPH")
    assert RwiWire(MASK).feed(spoken) == [RwiEvent("BS", 0xFFFB), ITEMS]


def test_a_report_with_a_damaged_item_is_dropped_whole_and_counted() -> None:
    wire = RwiWire(MASK)
    assert wire.feed(REPORT.replace(b"BPY", b"BPZ")) == []
    assert wire.counters["reports_damaged"] == 1
    assert wire.feed(REPORT) == [ITEMS]


@pytest.mark.parametrize(
    ("mnemonic", "argument", "data"),
    [
        ("HD", None, "48 44 0D"),
        ("TV", 8190, "54 56 20 31 66 66 65 0D"),
        ("TA", 0x1554, "54 41 20 31 35 35 34 0D"),
        ("RV", 85, "52 56 20 35 35 0D"),
        ("RA", 0xF1, "52 41 20 66 31 0D"),
        ("T+", None, "54 2B 0D"),
        ("TH", None, "54 48 0D"),
        ("R-", None, "52 2D 0D"),
        ("SD", MASK, "53 44 20 65 30 65 66 30 0D"),
        ("SP", 32, "53 50 20 32 30 0D"),
        ("WD", 256, "57 44 20 31 30 30 0D"),
        ("BE", 0, "42 45 20 30 0D"),
        ("BE", 0xFFFFFFFF, "42 45 20 66 66 66 66 66 66 66 66 0D"),
        ("KI", None, "4B 49 0D"),
        ("RP", 0x80000200, "52 50 20 38 30 30 30 30 32 30 30 0D"),
    ],
)
def test_commands_are_those_of_the_documents(mnemonic: str, argument: int | None, data: str) -> None:
    assert command(mnemonic, argument) == bytes.fromhex(data)


def test_an_argument_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="does not fit"):
        command("TV", -1)


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_memory_is_bounded(pieces: list[bytes]) -> None:
    wire = RwiWire(MASK)
    for piece in pieces:
        wire.feed(piece)
    wire.feed(b"x" * 10_000)
    assert len(wire._begun) <= 64
    wire.feed(b"\r")
    assert wire.feed(b"BV 1\r") == [RwiAnswer("BV", 1)]
