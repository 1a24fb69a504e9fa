"""The vectors of the maker's manual, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire import dynamixel
from robotd.hardware.wire.dynamixel import (
    DynamixelWire,
    Instruction,
    Message,
    ServoStatus,
    packet,
    read,
    sync_write,
    write,
)

VECTORS: list[tuple[str, Message]] = [
    ("FF FF FD 00 01 07 00 55 00 06 04 26 65 5D", ServoStatus(1, 0, b"\x06\x04\x26")),
    ("FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0", ServoStatus(1, 0, b"\xa6\x00\x00\x00")),
    ("FF FF FD 00 01 03 00 01 19 4E", Instruction(1, 1, b"")),
]


@pytest.mark.parametrize(("text", "message"), VECTORS)
def test_each_vector_is_understood_whole_byte_by_byte_and_after_garbage(text: str, message: Message) -> None:
    data = bytes.fromhex(text)
    assert DynamixelWire().feed(data) == [message]
    wire = DynamixelWire()
    assert [one for byte in data for one in wire.feed(bytes((byte,)))] == [message]
    assert DynamixelWire().feed(b"\xff\xff\xff\xfd\x00\x01\xff\xff\x00" + data) == [message]


@pytest.mark.parametrize(
    ("made", "text"),
    [
        (packet(1, dynamixel.PING), "FF FF FD 00 01 03 00 01 19 4E"),
        (read(1, dynamixel.PRESENT_POSITION, 4), "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15"),
        (write(1, dynamixel.GOAL_POSITION, 512, 4), "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89"),
        (write(1, dynamixel.TORQUE_ENABLE, 1, 1), "FF FF FD 00 01 06 00 03 40 00 01 DB 66"),
        (write(1, dynamixel.BUS_WATCHDOG, 10, 1), "FF FF FD 00 01 06 00 03 62 00 0A 4A E4"),
        (
            sync_write(dynamixel.GOAL_POSITION, 4, {1: 2048, 2: 1024}),
            "FF FF FD 00 FE 11 00 83 74 00 04 00 01 00 08 00 00 02 00 04 00 00 98 4C",
        ),
        (packet(dynamixel.BROADCAST, dynamixel.PING), "FF FF FD 00 FE 03 00 01 31 42"),
    ],
)
def test_packets_are_those_of_the_manual(made: bytes, text: str) -> None:
    assert made == bytes.fromhex(text)


@given(st.integers(0, 252), st.integers(0, 255), st.binary(max_size=40))
def test_whatever_is_sent_is_understood_stuffing_and_all(servo: int, instruction: int, parameters: bytes) -> None:
    parameters += b"\xff\xff\xfd"
    expected = Instruction(servo, instruction, parameters)
    if instruction == dynamixel.STATUS:
        expected = ServoStatus(servo, parameters[0], parameters[1:])  # type: ignore[assignment]  # the other kind of message
    assert DynamixelWire().feed(packet(servo, instruction, parameters)) == [expected]


@given(st.integers(0, 13), st.integers(0, 7))
def test_a_packet_with_one_bit_flipped_is_never_believed(at: int, bit: int) -> None:
    data = bytearray.fromhex(VECTORS[0][0])
    data[at] ^= 1 << bit
    assert DynamixelWire().feed(bytes(data)) == []


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_memory_is_bounded(pieces: list[bytes]) -> None:
    wire = DynamixelWire()
    for piece in pieces:
        wire.feed(piece)
    wire.feed(bytes(10_000))
    assert len(wire._begun) <= 140
    wire.feed(bytes(140))
    assert wire.feed(bytes.fromhex(VECTORS[0][0])) == [VECTORS[0][1]]
