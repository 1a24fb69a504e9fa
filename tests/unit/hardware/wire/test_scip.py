"""The examples of the maker's documents, whole, byte by byte, and after garbage."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.hardware.wire import scip
from robotd.hardware.wire.scip import (
    BLOCK_MAX_LINES,
    LINE_MAX_BYTES,
    Parameters,
    ScipReply,
    ScipVerdict,
    ScipWire,
    decoded,
    one_scan,
    sum_of,
)

PARAMETERS = (
    b"PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\nDMAX:5600;_\nARES:1024;\\\n"
    b"AMIN:44;7\nAMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\n"
)
URG = Parameters("URG-04LX(Hokuyo Automatic Co.,Ltd.)", 20, 5600, 1024, 44, 725, 384)
UTM = Parameters("UTM-30LX", 23, 60_000, 1440, 0, 1080, 540)


def scan_of(*distances: str) -> bytes:
    stamp, text = "0000", "".join(distances)
    return f"MD0044004600000\n99b\n{stamp}{sum_of(stamp)}\n{text}{sum_of(text)}\n\n".encode()


SCAN = scan_of("1Dh", "00A", "0Cb")
VECTORS: list[tuple[bytes, ScipReply]] = [
    (b"QT\n00P\n\n", ScipReply("QT", "00")),
    (b"BM\r\n02R\r\n\r\n", ScipReply("BM", "02")),
    (SCAN, ScipReply("MD0044004600000", "99", ("0000", "1Dh00A0Cb"))),
]


@pytest.mark.parametrize(("data", "message"), VECTORS)
def test_each_answer_is_understood_whole_byte_by_byte_and_after_garbage(data: bytes, message: ScipReply) -> None:
    assert ScipWire().feed(data) == [message]
    wire = ScipWire()
    assert [one for byte in data for one in wire.feed(bytes((byte,)))] == [message]
    wire = ScipWire()
    assert wire.feed(b"\xff\x00noise\nMD0044\n99x\n\n" + data) == [message]
    assert wire.counters == {"replies": 1, "sum_errors": 1, "bytes_skipped": 7}


def test_the_example_of_the_parameters_is_understood() -> None:
    (reply,) = ScipWire().feed(PARAMETERS)
    assert Parameters.of(reply) == URG


@pytest.mark.parametrize("line", [b"DMIN:20;4\n", b"AFRT:384;6\n", b"MODL"])
def test_parameters_without_one_of_them_or_with_one_damaged_are_none(line: bytes) -> None:
    replies = ScipWire().feed(PARAMETERS.replace(line, b"" if line.endswith(b"\n") else b"NODL"))
    assert [Parameters.of(reply) for reply in replies] == ([None] if line.endswith(b"\n") else [])


@pytest.mark.parametrize(("key", "value"), [("ARES", 0), ("AMAX", 44), ("AFRT", 9999), ("AMIN", -1), ("ARES", 99999)])
def test_parameters_that_cannot_be_are_none(key: str, value: int) -> None:
    said = {"DMIN": 20, "DMAX": 5600, "ARES": 1024, "AMIN": 44, "AMAX": 725, "AFRT": 384, key: value}
    assert Parameters.of(ScipReply("PP", "00", tuple(f"{name}:{number}" for name, number in said.items()))) is None


def test_a_distance_is_three_characters_of_six_bits() -> None:
    assert decoded("1Dh") == 5432
    (scan,) = ScipWire().feed(SCAN)
    assert scan.distances_mm == (5432, 17, 0o2362)
    assert ScipReply("PP", "00", ("DMIN:20",)).distances_mm is None
    assert ScipReply("MD", "99", ("0000", "1Dh0")).distances_mm is None
    assert ScipReply("MD", "99").distances_mm is None


def test_no_flipped_bit_makes_another_scan() -> None:
    start = SCAN.index(b"99b")
    for at in range(8 * start, 8 * (len(SCAN) - 2)):
        flipped = bytearray(SCAN)
        flipped[at // 8] ^= 1 << at % 8
        for reply in ScipWire().feed(bytes(flipped)):
            is_whole = reply.distances_mm is not None and len(reply.distances_mm) == 3
            assert reply.status != scip.DATA or not is_whole or reply.distances_mm == (5432, 17, 0o2362), at


def test_commands_are_those_of_the_document() -> None:
    assert scip.PARAMETERS == b"PP\n"
    assert scip.QUIT == b"QT\n"
    assert one_scan(44, 725) == b"MD0044072500001\n"


@pytest.mark.parametrize(
    ("parameters", "distance_mm", "verdict"),
    [
        (URG, 20, None),
        (URG, 5600, None),
        (URG, 5601, ScipVerdict.UNKNOWN),
        (URG, 0, ScipVerdict.UNKNOWN),
        (URG, 1, ScipVerdict.WEAK),
        (URG, 18, ScipVerdict.SATURATED),
        (URG, 7, ScipVerdict.UNKNOWN),
        (UTM, 1, ScipVerdict.NOTHING),
        (UTM, 2, ScipVerdict.TOO_NEAR),
        (UTM, 4, ScipVerdict.TOO_NEAR),
        (UTM, 5, ScipVerdict.UNKNOWN),
    ],
)
def test_codes_are_judged_by_the_table_of_their_model(
    parameters: Parameters, distance_mm: int, verdict: ScipVerdict | None
) -> None:
    assert parameters.verdict(distance_mm) is verdict


@given(st.lists(st.binary(max_size=40), max_size=20))
def test_whatever_comes_nothing_is_raised_and_memory_is_bounded(pieces: list[bytes]) -> None:
    wire = ScipWire()
    for piece in pieces:
        wire.feed(piece)
    wire.feed(b"x" * 1000 + b"\n" + b"y\n" * 1000)
    assert len(wire._begun) <= LINE_MAX_BYTES
    assert len(wire._block) <= BLOCK_MAX_LINES
    wire.feed(b"\n\n")
    assert wire.feed(b"QT\n00P\n\n") == [ScipReply("QT", "00")]
