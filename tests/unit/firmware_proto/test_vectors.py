"""The shared vectors and the code agree, and neither was checked only against itself."""

import binascii
import json
from importlib import resources
from typing import Any

import pytest
from cobs import cobs

from firmware_proto.common import Ack, BoardKind
from firmware_proto.dictionary import answers_for, messages_for, requests_for
from firmware_proto.framing import Deframer, RawFrame, encode_frame
from firmware_proto.schema import REPLY, Message, payload_size, wire_fields

FILES = ("common", "drive", "pantilt", "rangefinder", "framing")
STOP = RawFrame(0x11, 3, b"")


def _load(name: str) -> list[dict[str, Any]]:
    text = resources.files("firmware_proto").joinpath("vectors", f"{name}.json").read_text(encoding="utf-8")
    return list(json.loads(text)["vectors"])


VECTORS = {f"{name}: {vector['label']}": vector for name in FILES for vector in _load(name)}
SINGLE = {label: vector for label, vector in VECTORS.items() if not label.startswith("framing")}
BY_NAME = {message.__name__: message for kind in BoardKind for message in messages_for(kind)}

each_vector = pytest.mark.parametrize("vector", VECTORS.values(), ids=VECTORS.keys())
each_message = pytest.mark.parametrize("vector", SINGLE.values(), ids=SINGLE.keys())


def _frames(vector: dict[str, Any]) -> list[RawFrame]:
    return [RawFrame(one["type"], one["seq"], bytes.fromhex(one["payload"])) for one in vector["frames"]]


def _errors(deframer: Deframer) -> dict[str, int]:
    return {"crc": deframer.crc_errors, "cobs": deframer.cobs_errors, "length": deframer.length_errors}


def _fields(message: Message) -> dict[str, Any]:
    values = {name: getattr(message, name) for name in wire_fields(type(message))}
    return {name: value.hex(" ").upper() if isinstance(value, bytes) else value for name, value in values.items()}


@each_vector
def test_decodes_whole(vector: dict[str, Any]) -> None:
    deframer = Deframer()
    assert deframer.feed(bytes.fromhex(vector["wire"])) == _frames(vector)
    assert _errors(deframer) == vector["errors"]


@each_vector
def test_decodes_byte_by_byte(vector: dict[str, Any]) -> None:
    deframer = Deframer()
    found = [frame for byte in bytes.fromhex(vector["wire"]) for frame in deframer.feed(bytes([byte]))]
    assert found == _frames(vector)
    assert _errors(deframer) == vector["errors"]


@each_message
@pytest.mark.parametrize("garbage", [b"\x55", b"\0\0\0", b"\xff" * 300, b"\x02\x11\x02", bytes(range(255, 0, -1))])
def test_decodes_after_garbage(vector: dict[str, Any], garbage: bytes) -> None:
    deframer = Deframer()
    deframer.feed(garbage)
    assert deframer.feed(bytes.fromhex(vector["wire"])) == _frames(vector)


@each_vector
def test_leaves_nothing_behind_that_harms_the_next_frame(vector: dict[str, Any]) -> None:
    deframer = Deframer()
    deframer.feed(bytes.fromhex(vector["wire"]))
    assert deframer.feed(encode_frame(STOP)) == [STOP]


@each_message
def test_encodes_to_the_same_bytes(vector: dict[str, Any]) -> None:
    (frame,) = _frames(vector)
    assert encode_frame(frame) == bytes.fromhex(vector["wire"])


@each_message
def test_wire_bytes_agree_with_an_independent_encoder(vector: dict[str, Any]) -> None:
    (one,) = vector["frames"]
    body = bytes([one["type"], 0, one["seq"] & 0xFF, one["seq"] >> 8]) + bytes.fromhex(one["payload"])
    crc = binascii.crc_hqx(body, 0xFFFF)
    assert b"\0" + cobs.encode(body + bytes([crc >> 8, crc & 0xFF])) + b"\0" == bytes.fromhex(vector["wire"])


@each_message
def test_payload_and_fields_agree_both_ways(vector: dict[str, Any]) -> None:
    (one,) = vector["frames"]
    layout = BY_NAME[one["message"]]
    payload = bytes.fromhex(one["payload"])
    message = layout.from_payload(payload)
    assert _fields(message) == one["fields"]
    assert message.to_payload() == payload


@each_message
def test_type_says_which_message_it_is(vector: dict[str, Any]) -> None:
    (one,) = vector["frames"]
    spoken = [layouts for kind in BoardKind for layouts in (requests_for(kind), answers_for(kind))]
    assert {layouts[one["type"]].__name__ for layouts in spoken if one["type"] in layouts} == {one["message"]}


def test_refused_frames_are_refused_for_the_reason_given() -> None:
    for vector in _load("framing"):
        for one in vector["frames"]:
            sizes = {
                payload_size(layouts[one["type"]])
                for kind in BoardKind
                for layouts in (requests_for(kind), answers_for(kind))
                if one["type"] in layouts
            }
            expected = "UNKNOWN_TYPE" if not sizes else None
            if sizes and len(bytes.fromhex(one["payload"])) not in sizes:
                expected = "BAD_LENGTH"
            assert one.get("refused") == expected, vector["label"]


def test_every_message_and_every_reply_type_has_a_vector() -> None:
    seen = {(one["type"], one["message"]) for vector in SINGLE.values() for one in vector["frames"]}
    requests = {(code, one.__name__) for kind in BoardKind for code, one in requests_for(kind).items()}
    answers = {(code, one.__name__) for kind in BoardKind for code, one in answers_for(kind).items()}
    assert requests | answers == seen
    assert (Ack.TYPE, "Ack") not in seen  # Ack always carries the type of what it answers
    assert all(code > REPLY for code, _ in answers)


@pytest.mark.parametrize(
    ("label", "wire"),
    [
        ("common: Hello 1.0, nonce DEADBEEF", "00 02 01 01 01 02 01 07 EF BE AD DE 3F B7 00"),
        (
            "common: HelloReply: dictionary of 812 bytes with crc32 12345678, boot 7, 1 MHz",
            "00 02 81 01 01 02 01 0C EF BE AD DE 2C 03 78 56 34 12 07 01 01 04 40 42 0F 03 C2 1B 00",
        ),
        ("common: Ping", "00 02 02 02 01 05 15 CD 5B 07 01 01 01 03 D0 A1 00"),
        ("common: Pong", "00 02 82 02 01 05 15 CD 5B 07 01 01 01 03 88 13 01 01 01 01 01 03 2D D2 00"),
        ("drive: SetVelocity: 300 mm/s, -500 mrad/s, 250 ms", "00 02 10 02 02 06 2C 01 0C FE FA 03 25 D8 00"),
        ("drive: Ack of SetVelocity", "00 02 90 02 02 01 03 59 E6 00"),
        ("common: Stop", "00 02 11 02 03 03 BC 80 00"),
        ("framing: the last CRC byte is 81 instead of 80", "00 02 11 02 03 03 BC 81 00"),
        ("framing: a COBS code runs past the end", "00 05 01 00"),
    ],
)
def test_the_protocols_founding_vectors_are_among_them(label: str, wire: str) -> None:
    assert VECTORS[label]["wire"] == wire


def test_reserved_payload_bytes_do_not_exist() -> None:
    for message in BY_NAME.values():
        packed = message.from_payload(bytes(payload_size(message))).to_payload()
        assert packed == bytes(payload_size(message))
