"""The host's side of the board protocol: typed messages out of bytes, damage counted."""

import json
import time
from importlib import resources
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_proto.common import Ack, Arm, BoardKind, BoardStatus, HelloReply, Kill, Nack, Ping, Pong, Result, Stop
from firmware_proto.drive_messages import DriveReport, OdometryReport, SetVelocity
from firmware_proto.framing import Deframer, RawFrame, encode_frame
from firmware_proto.rangefinder_messages import Shot, ShotStatus
from firmware_proto.schema import Message
from robotd.core.errors import LocalProtocolError
from robotd.hardware.wire.board import EMERGENCY_SEQ, STOP_BYTES, BoardWire, Received, WireCounters
from tests.support.own_boards import KILL_BYTES

NO_GAPS = WireCounters(0, 0, 0, 0, 0, 0)


def _wire_of(message: Message, seq: int, code: int | None = None) -> bytes:
    return encode_frame(RawFrame(message.TYPE if code is None else code, seq, message.to_payload()))


def _status(seq: int) -> bytes:
    return _wire_of(BoardStatus(0, 0, 0, 0, 0, 0), seq)


def _vectors(name: str) -> list[dict[str, Any]]:
    text = resources.files("firmware_proto").joinpath("vectors", f"{name}.json").read_text(encoding="utf-8")
    return list(json.loads(text)["vectors"])


def _from_board(name: str) -> list[Any]:
    return [
        pytest.param(name, vector, id=f"{name}: {vector['label']}")
        for vector in _vectors(name)
        if all(frame["type"] >= 0x80 for frame in vector["frames"])
    ]


ANSWERS = [one for name in ("drive", "pantilt", "rangefinder") for one in _from_board(name)]


def _summary(one: Received) -> tuple[int, int, str]:
    return one.type, one.seq, type(one.message).__name__


@pytest.mark.parametrize(("name", "vector"), ANSWERS)
def test_what_boards_say_is_understood_whole_byte_by_byte_and_after_garbage(name: str, vector: dict[str, Any]) -> None:
    expected = [(one["type"], one["seq"], one["message"]) for one in vector["frames"]]
    data = bytes.fromhex(vector["wire"])
    kind = BoardKind[name.upper()]
    bytewise = BoardWire(kind)
    noisy = BoardWire(kind)
    noisy.feed(b"\x55\xaa\x00\x07")
    assert [_summary(one) for one in BoardWire(kind).feed(data)] == expected
    assert [_summary(one) for byte in data for one in bytewise.feed(bytes([byte]))] == expected
    assert [_summary(one) for one in noisy.feed(data)] == expected


@pytest.mark.parametrize("kind", BoardKind)
def test_messages_common_to_all_boards_are_understood(kind: BoardKind) -> None:
    for vector in _vectors("common"):
        (frame,) = vector["frames"]
        heard = BoardWire(kind).feed(bytes.fromhex(vector["wire"]))
        assert len(heard) == (frame["type"] >= 0x80), vector["label"]


def test_a_reply_is_typed_by_its_request() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    assert wire.feed(_wire_of(Ack(0), 2, SetVelocity.TYPE | 0x80)) == [Received(0x90, 2, Ack(0))]
    assert wire.feed(_wire_of(Pong(1, 2), 9)) == [Received(0x82, 9, Pong(1, 2))]
    refusal = Nack(Result.WRONG_STATE, SetVelocity.TYPE)
    assert wire.feed(_wire_of(refusal, 3)) == [Received(0xFE, 3, refusal)]


def test_requests_are_encoded_as_the_vectors_say() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    assert wire.encode(SetVelocity(300, -500, 250), 2).hex(" ") == "00 02 10 02 02 06 2c 01 0c fe fa 03 25 d8 00"
    assert wire.encode(Stop(), 3).hex(" ") == "00 02 11 02 03 03 bc 80 00"


def test_seq_counts_modulo_65536() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    assert wire.encode(Arm(), 65536 + 5) == wire.encode(Arm(), 5)


def test_a_value_that_does_not_fit_is_our_mistake() -> None:
    with pytest.raises(LocalProtocolError, match=r"SetVelocity.*does not fit"):
        BoardWire(BoardKind.DRIVE).encode(SetVelocity(40_000, 0, 250), 0)


@pytest.mark.parametrize(("data", "request_type"), [(STOP_BYTES, Stop.TYPE), (KILL_BYTES, Kill.TYPE)])
def test_emergency_bytes_are_whole_frames(data: bytes, request_type: int) -> None:
    assert Deframer().feed(b"\x55" + data) == [RawFrame(request_type, EMERGENCY_SEQ, b"")]


def test_an_emergency_stop_survives_a_frame_cut_off_before_it() -> None:
    half = BoardWire(BoardKind.DRIVE).encode(SetVelocity(300, 0, 250), 0)[:7]
    assert Deframer().feed(half + STOP_BYTES) == [RawFrame(Stop.TYPE, EMERGENCY_SEQ, b"")]


def test_a_wrong_size_is_counted_and_dropped() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    assert wire.feed(encode_frame(RawFrame(0x82, 0, b"\x01")) + _wire_of(Ack(0), 0, 0x85)) == [
        Received(0x85, 0, Ack(0))
    ]
    assert wire.counters == WireCounters(2, 0, 0, 1, 0, 0)


def test_types_that_the_board_does_not_speak_are_counted_and_dropped() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    assert wire.feed(_wire_of(Shot(0, 0, 0, ShotStatus.OK), 0) + _wire_of(Ping(0), 0)) == []
    assert wire.counters == WireCounters(2, 0, 0, 0, 2, 0)


def test_damage_is_counted_by_kind() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    good = _wire_of(Pong(1, 2), 9)
    bad_crc = good[:-2] + bytes([good[-2] ^ 1]) + good[-1:]
    wire.feed(bad_crc + b"\x05\x01\x00" + b"\x01" * 300 + b"\x00")
    assert wire.counters == WireCounters(0, 1, 1, 1, 0, 0)


@given(st.binary(max_size=400))
def test_no_bytes_make_it_raise(data: bytes) -> None:
    wire = BoardWire(BoardKind.RANGEFINDER)
    wire.feed(data)
    assert len(wire.feed(_wire_of(Pong(1, 2), 9))) == 1


def test_gaps_in_telemetry_are_counted_per_type() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    for seq in (5, 6, 9):
        wire.feed(_status(seq))
    for seq in (100, 101):
        wire.feed(_wire_of(OdometryReport(0, 0, 0, 0, 0), seq))
    wire.feed(_wire_of(DriveReport(0, 0, 0), 7))
    assert wire.counters.telemetry_gaps == 2


def test_the_telemetry_counter_may_wrap() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    for seq in (65534, 65535, 0, 1, 3):
        wire.feed(_status(seq))
    assert wire.counters.telemetry_gaps == 1


def test_a_repeated_or_restarted_counter_is_no_gap() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    for seq in (500, 501, 501, 0, 1):
        wire.feed(_status(seq))
    assert wire.counters.telemetry_gaps == 0


def test_a_session_counts_from_zero() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    wire.feed(_status(500))
    wire.feed(_wire_of(HelloReply(1, 0, 7, 100, 0, 1, 1_000_000), 0))
    wire.feed(_status(2))
    assert wire.counters.telemetry_gaps == 2


def test_replies_are_no_telemetry() -> None:
    wire = BoardWire(BoardKind.DRIVE)
    for seq in (0, 90, 7):
        wire.feed(_wire_of(Ack(0), seq, 0x85))
    assert wire.counters.telemetry_gaps == 0


def test_a_fresh_wire_has_counted_nothing() -> None:
    assert BoardWire(BoardKind.PANTILT).counters == NO_GAPS


def test_a_thousand_reports_take_a_fraction_of_a_second() -> None:
    data = b"".join(_wire_of(OdometryReport(seq, seq, seq, 1, 1), seq) for seq in range(1000))
    wire = BoardWire(BoardKind.DRIVE)
    start_s = time.process_time()
    assert len(wire.feed(data)) == 1000
    assert time.process_time() - start_s < 0.5
