"""Frames against the standards they claim: COBS, CRC-16, and bounded patience with noise."""

import random
import struct

import pytest
from cobs import cobs
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_proto.framing import PACKET_MAX, Deframer, RawFrame, cobs_decode, cobs_encode, crc16, encode_frame

FRAMES = st.builds(
    RawFrame, type=st.integers(0, 255), seq=st.integers(0, 65535), payload=st.binary(min_size=0, max_size=240)
)
STOP = encode_frame(RawFrame(0x11, 3, b""))


def test_crc_has_the_published_check_value() -> None:
    assert crc16(b"123456789") == 0x29B1


@pytest.mark.parametrize("frame", ["C0 38 BC", "C1 02 02 9B 7B", "81 60 59"])
def test_crc_agrees_with_frames_of_the_zigbee_serial_protocol(frame: str) -> None:
    assert crc16(bytes.fromhex(frame)) == 0


def test_crc_is_not_the_reflected_variant() -> None:
    klipper_block = bytes.fromhex("05 11 8F 08")
    assert crc16(klipper_block[:2]) != int.from_bytes(klipper_block[2:], "big")


@given(st.binary(max_size=253))
def test_cobs_encodes_as_the_reference_does(data: bytes) -> None:
    assert cobs_encode(data) == cobs.encode(data)
    assert cobs_decode(cobs_encode(data)) == data


@given(st.binary(max_size=600).map(lambda data: data.replace(b"\0", b"\1")))
def test_cobs_decodes_as_the_reference_does(packet: bytes) -> None:
    try:
        expected = cobs.decode(packet)
    except cobs.DecodeError:
        expected = None
    assert cobs_decode(packet) == expected


@given(st.integers(254, 1000))
def test_cobs_decodes_blocks_longer_than_it_encodes(size: int) -> None:
    data = bytes([7]) * size
    assert cobs_decode(cobs.encode(data)) == data


def test_what_does_not_fit_one_packet_is_refused() -> None:
    with pytest.raises(ValueError, match="254 bytes"):
        cobs_encode(bytes(254))
    with pytest.raises(ValueError, match="payload of 241 bytes"):
        encode_frame(RawFrame(1, 0, bytes(241)))
    with pytest.raises(struct.error):
        encode_frame(RawFrame(1, 65536, b""))


@given(st.lists(FRAMES, max_size=5), st.data())
def test_frames_come_back_however_the_stream_is_cut(frames: list[RawFrame], data: st.DataObject) -> None:
    stream = b"".join(encode_frame(frame) for frame in frames)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=6)))
    deframer = Deframer()
    found = [
        frame
        for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True)
        for frame in deframer.feed(stream[start:end])
    ]
    assert found == frames
    assert deframer.frames == len(frames)
    assert (deframer.crc_errors, deframer.cobs_errors, deframer.length_errors) == (0, 0, 0)


@given(FRAMES)
def test_a_frame_has_no_zero_inside_and_costs_nine_bytes(frame: RawFrame) -> None:
    wire = encode_frame(frame)
    assert wire[0] == wire[-1] == 0
    assert 0 not in wire[1:-1]
    assert len(wire) == len(frame.payload) + 9


@settings(max_examples=200)
@given(st.binary(max_size=2000))
def test_garbage_never_raises_and_never_hides_the_frame_after_it(garbage: bytes) -> None:
    deframer = Deframer()
    deframer.feed(garbage)
    assert RawFrame(0x11, 3, b"") in deframer.feed(STOP)


@given(st.binary(min_size=1, max_size=300))
def test_garbage_that_eats_a_delimiter_costs_one_frame(garbage: bytes) -> None:
    deframer = Deframer()
    deframer.feed(garbage + STOP[1:])
    assert deframer.feed(STOP) == [RawFrame(0x11, 3, b"")]


def test_memory_is_bounded_whatever_comes() -> None:
    noise = random.Random(4).randbytes(100_000).replace(b"\0", b"\1")
    deframer = Deframer()
    for start in range(0, len(noise), 1000):
        deframer.feed(noise[start : start + 1000])
        assert len(deframer._rest) <= PACKET_MAX + 1
    assert deframer.feed(STOP) == [RawFrame(0x11, 3, b"")]
    assert deframer.length_errors == 1


def test_random_megabytes_are_counted_and_hardly_ever_believed() -> None:
    deframer = Deframer()
    found = deframer.feed(random.Random(5).randbytes(300_000))
    assert len(found) == deframer.frames <= 1
    assert deframer.cobs_errors > 500
    assert deframer.length_errors > 50
