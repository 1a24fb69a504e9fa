"""No single damage to any frame makes another message of it: exhaustive, over every type of frame."""

import json
from collections.abc import Iterator
from importlib import resources

import pytest

from firmware_proto.common import BoardKind
from firmware_proto.dictionary import answers_for, requests_for
from firmware_proto.framing import Deframer, RawFrame
from firmware_proto.schema import payload_size

FILES = ("common", "drive", "pantilt", "rangefinder")
SIZES = {
    code: payload_size(layout)
    for kind in BoardKind
    for layouts in (requests_for(kind), answers_for(kind))
    for code, layout in layouts.items()
}
STOP_WIRE = bytes.fromhex("00 02 11 02 03 03 BC 80 00")
STOP = RawFrame(0x11, 3, b"")


def _wires() -> dict[str, bytes]:
    vectors = [
        vector
        for name in FILES
        for vector in json.loads(
            resources.files("firmware_proto").joinpath("vectors", f"{name}.json").read_text(encoding="utf-8")
        )["vectors"]
    ]
    return {vector["label"]: bytes.fromhex(vector["wire"]) for vector in vectors}


WIRES = _wires()
each_frame = pytest.mark.parametrize("wire", WIRES.values(), ids=WIRES.keys())


def _flipped(wire: bytes) -> Iterator[bytes]:
    for at in range(len(wire)):
        for bit in range(8):
            yield wire[:at] + bytes([wire[at] ^ 1 << bit]) + wire[at + 1 :]


def _dropped(wire: bytes) -> Iterator[bytes]:
    for at in range(len(wire)):
        yield wire[:at] + wire[at + 1 :]


def _doubled(wire: bytes) -> Iterator[bytes]:
    for at in range(len(wire)):
        yield wire[: at + 1] + wire[at:]


def _inserted(wire: bytes) -> Iterator[bytes]:
    for at in range(len(wire) + 1):
        for value in range(256):
            yield wire[:at] + bytes([value]) + wire[at:]


def _truncated(wire: bytes) -> Iterator[bytes]:
    for at in range(len(wire)):
        yield wire[:at]


def _accepted(stream: bytes) -> list[RawFrame]:
    """Return the messages that a receiver would act on."""
    return [frame for frame in Deframer().feed(stream) if SIZES.get(frame.type) == len(frame.payload)]


@pytest.mark.parametrize("damage", [_flipped, _dropped, _doubled, _inserted, _truncated])
@each_frame
def test_damage_is_noticed_or_harmless_and_the_next_frame_survives(wire: bytes, damage: object) -> None:
    assert callable(damage)
    (original,) = _accepted(wire)
    for damaged in damage(wire):
        *found, last = _accepted(damaged + STOP_WIRE)
        assert found in ([], [original]), damaged.hex(" ")
        assert last == STOP


def test_every_type_of_frame_is_damaged_here() -> None:
    assert {_accepted(wire)[0].type for wire in WIRES.values()} == set(SIZES)


@each_frame
def test_a_frame_in_two_or_three_pieces_is_the_same_frame(wire: bytes) -> None:
    (original,) = _accepted(wire)
    for first in range(len(wire) + 1):
        for second in range(first, len(wire) + 1):
            deframer = Deframer()
            pieces = (wire[:first], wire[first:second], wire[second:])
            assert [frame for piece in pieces for frame in deframer.feed(piece)] == [original]


@each_frame
def test_a_frame_said_twice_is_twice_the_same_frame_and_the_next_survives(wire: bytes) -> None:
    (original,) = _accepted(wire)
    assert _accepted(wire + wire + STOP_WIRE) == [original, original, STOP]
    assert _accepted(wire[:-1] + wire + STOP_WIRE) == [original, original, STOP]


@each_frame
def test_damage_inside_a_frame_never_lets_it_through(wire: bytes) -> None:
    inside = slice(1, -1)
    for damage in (_flipped, _dropped):
        for damaged in damage(wire[inside]):
            assert _accepted(b"\0" + damaged + b"\0") == []


@each_frame
def test_a_split_by_a_stray_delimiter_never_lets_a_piece_through(wire: bytes) -> None:
    for at in range(2, len(wire) - 1):
        assert _accepted(wire[:at] + b"\0" + wire[at:]) == []
