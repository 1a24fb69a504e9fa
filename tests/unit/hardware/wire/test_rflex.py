"""The vectors of the documents, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire import rflex
from robotd.hardware.wire.rflex import AxisReport, Message, RflexWire, Switches, SystemStatus, safe_speed, set_direction

REPORT = "1B 02 02 07 21 19 00 00 00 00 00 01 E2 40 00 00 03 16 DC 00 00 76 A1 00 01 8B 6E 00 00 75 30 21 1B 03"
VECTORS: list[tuple[str, Message]] = [
    (REPORT, AxisReport(0, 202460, 30369)),
    (
        "1B 02 02 08 21 19 00 00 00 00 00 01 E2 40 01 FF FF 75 F0 FF FF BA F9 00 01 86 A0 00 00 88 B8 41 1B 03",
        AxisReport(1, -35344, -17671),
    ),
    ("1B 02 01 09 01 09 00 00 03 E8 00 00 09 7E 01 9D 1B 03", SystemStatus(2430, 1)),
    ("1B 02 05 0A 01 07 00 00 03 E8 42 00 03 A3 1B 03", Switches(0x42, b"\x00\x03")),
]


@pytest.mark.parametrize(("text", "message"), VECTORS)
def test_each_vector_is_understood_whole_byte_by_byte_and_after_garbage(text: str, message: Message) -> None:
    data = bytes.fromhex(text)
    assert RflexWire().feed(data) == [message]
    wire = RflexWire()
    assert [one for byte in data for one in wire.feed(bytes((byte,)))] == [message]
    wire = RflexWire()
    assert wire.feed(b"\x1b\x00\xff\x1b\x1b\x02\x09\x00\x01\xff" + data) == [message]


def test_a_report_with_any_byte_changed_is_dropped_and_the_next_one_found() -> None:
    data = bytes.fromhex(REPORT)
    for at in range(2, len(data)):
        damaged = bytes(byte ^ (0x10 if i == at else 0) for i, byte in enumerate(data))
        wire = RflexWire()
        assert AxisReport(0, 202460, 30369) not in wire.feed(damaged), at
        assert wire.feed(data + data + data)[-1] == AxisReport(0, 202460, 30369), at


@pytest.mark.parametrize(
    ("made", "text"),
    [
        (rflex.BRAKE_RELEASE, "1B 02 02 00 0C 00 0E 1B 03"),
        (rflex.BRAKE_SET, "1B 02 02 00 0B 00 09 1B 03"),
        (rflex.DEFAULTS, "1B 02 02 00 0A 00 08 1B 03"),
        (rflex.report_every(100_000), "1B 02 02 00 22 08 00 01 86 A0 00 00 00 03 0C 1B 03"),
        (rflex.switches_every(100_000), "1B 02 05 00 00 04 00 01 86 A0 26 1B 03"),
        (
            set_direction(0, 30369, 101_230, 30_000, forwards=True),
            "1B 02 02 00 07 0E 00 00 00 76 A1 00 01 8B 6E 00 00 75 30 01 7C 1B 03",
        ),
        (
            set_direction(1, 17671, 100_000, 35_000, forwards=False),
            "1B 02 02 00 07 0E 01 00 00 45 07 00 01 86 A0 00 00 88 B8 00 5F 1B 03",
        ),
    ],
)
def test_orders_are_those_of_the_documents(made: bytes, text: str) -> None:
    assert made == bytes.fromhex(text)


@given(st.integers(0, 0x00FFFFFF))
def test_a_safe_speed_is_no_faster_nearly_the_same_and_not_lost(speed: int) -> None:
    safe = safe_speed(speed)
    assert speed - 0x100 <= safe <= speed
    assert safe >> 8 & 0xFF != 0x1B


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_memory_is_bounded(pieces: list[bytes]) -> None:
    wire = RflexWire()
    for piece in pieces:
        wire.feed(piece)
    wire.feed(bytes(10_000))
    assert len(wire._begun) <= 80
    wire.feed(bytes(80))
    assert wire.feed(bytes.fromhex(REPORT)) == [AxisReport(0, 202460, 30369)]
