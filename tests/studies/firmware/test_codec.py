"""The C codec and the shared vectors agree, and so do C and Python on whatever else a line delivers."""

import json
from importlib import resources
from typing import Any

import pytest

from firmware_proto.framing import RawFrame, encode_frame
from tests.studies.firmware.codec import told_by_python
from tests.studies.firmware.conftest import Program
from tests.studies.firmware.streams import random_stream

FILES = ("common", "drive", "pantilt", "rangefinder", "framing")
VECTORS = {
    f"{name}: {vector['label']}": vector
    for name in FILES
    for vector in json.loads(
        resources.files("firmware_proto").joinpath("vectors", f"{name}.json").read_text(encoding="utf-8")
    )["vectors"]
}
each_vector = pytest.mark.parametrize("vector", VECTORS.values(), ids=VECTORS.keys())


def expected(one: dict[str, Any]) -> str:
    """Return what the C program should print for a frame of a vector."""
    fields = [f"{name}={squeezed(str(value))}" for name, value in one.get("fields", {}).items()]
    head = f"{one['type']} {one['seq']} {squeezed(one['payload'])}"
    return " ".join([head, one.get("message") or one["refused"], *fields])


def squeezed(value: str) -> str:
    return value.replace(" ", "").lower()


def found(told: str) -> tuple[list[str], list[str], str]:
    """Return the frames, what encoding them gave, and the counters."""
    *lines, counted = told.splitlines()
    encoded = [line.removeprefix("> ") for line in lines if line.startswith(">")]
    return [line for line in lines if not line.startswith(">")], encoded, counted


@each_vector
def test_finds_in_a_vector_what_it_says(codec: Program, vector: dict[str, Any]) -> None:
    frames, _, counted = found(codec(bytes.fromhex(vector["wire"])))
    assert frames == [expected(one) for one in vector["frames"]]
    assert counted == "{crc} {cobs} {length}".format(**vector["errors"])


@pytest.mark.parametrize("label", [label for label in VECTORS if not label.startswith("framing")])
def test_encodes_a_message_to_the_bytes_of_its_vector(codec: Program, label: str) -> None:
    wire = VECTORS[label]["wire"]
    _, encoded, _ = found(codec(bytes.fromhex(wire)))
    assert encoded == [squeezed(wire)]


@pytest.mark.parametrize("garbage", [b"\x55", b"\0\0\0", b"\xff" * 300, b"\x02\x11\x02", bytes(range(255, 0, -1))])
def test_finds_every_vector_after_garbage(codec: Program, garbage: bytes) -> None:
    singles = [vector for label, vector in VECTORS.items() if not label.startswith("framing")]
    frames, _, _ = found(codec(b"".join(garbage + bytes.fromhex(vector["wire"]) for vector in singles)))
    assert frames == [expected(one) for vector in singles for one in vector["frames"]]


@pytest.mark.parametrize("size", [0, 1, 252, 253, 254, 255, 256, 257, 258, 600])
@pytest.mark.parametrize("byte", [b"\x01", b"\x02", b"\xfe", b"\xff"])
def test_bounds_of_packets_are_those_of_python(codec: Program, size: int, byte: bytes) -> None:
    stream = b"\0" + byte * size + b"\0\xff" + b"\7" * size + encode_frame(RawFrame(0x11, 3, b""))
    assert codec(stream) == told_by_python(stream)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_a_line_delivers_c_and_python_make_the_same_of_it(codec: Program, seed: int) -> None:
    stream = random_stream(seed, 500)
    assert codec(stream) == told_by_python(stream)
