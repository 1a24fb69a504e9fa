"""The file of a map's stops comes back bit for bit; what is not one is refused by a MapError, in bounded memory."""

import dataclasses
import math
import tracemalloc
import zlib
from contextlib import suppress
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.errors import MapError
from robotd.core.map_stop import MapStop
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.map_stops import MapStops
from robotd.grid.settings import GridSettings, UpdatePolicy
from robotd.maps.stops_file import READINGS_MAX, SETTINGS_SINCE, STOPS_MAX, decode_stops, encode_stops
from tests.support.made_maps import made_stops

HEAD = b"robotd stops 1\n"
finite = st.floats(-1e6, 1e6)
poses = st.builds(Pose2, finite, finite, finite)
wholes = st.integers(-(2**62), 2**62)
measured = st.builds(
    RangeReading,
    wholes,
    finite,
    st.sampled_from([ReadingStatus.OK, ReadingStatus.MISS]),
    st.floats(0.0, 1e6, exclude_min=True),
    st.none() | wholes,
    finite,
    finite,
)
unmeasured = st.builds(
    RangeReading,
    wholes,
    finite,
    st.sampled_from(sorted(set(ReadingStatus) - {ReadingStatus.OK, ReadingStatus.MISS})),
    st.none(),
    st.none() | wholes,
)
sweeps = st.builds(Sweep, wholes, poses, st.lists(measured | unmeasured, max_size=5).map(tuple))
chosen = st.builds(GridSettings, raise_alpha=st.floats(0.0, 0.99), policy=st.sampled_from(UpdatePolicy))
made = st.builds(
    MapStops,
    chosen,
    st.lists(st.builds(MapStop.of, sweeps, poses), max_size=4).map(tuple),
    st.sampled_from(["several", "7d9b090dc6a24e48"]),
)


def bits(stops: MapStops) -> list[Any]:
    """Return all floats by their bits, so that -0.0 is not 0.0."""
    return [
        [number.hex() for number in (r.bearing_rad, r.range_m or 0.0, r.origin_x_m, r.origin_y_m)]
        for stop in stops.stops
        for r in stop.sweep.readings
    ]


@given(stops=made)
@settings(deadline=None)
def test_stops_come_back_bit_for_bit(stops: MapStops) -> None:
    again = decode_stops(encode_stops(stops))
    assert again == stops
    assert bits(again) == bits(stops)


def test_every_file_that_was_cut_is_refused() -> None:
    data = encode_stops(made_stops(1))
    for end in range(len(data)):
        with pytest.raises(MapError):
            decode_stops(data[:end])
    with pytest.raises(MapError):
        decode_stops(data + b"x")


def test_every_flipped_bit_is_noticed_or_says_the_same_in_another_way() -> None:
    stops = made_stops(1)
    data = encode_stops(stops)
    for at in range(len(data)):
        flipped = data[:at] + bytes([data[at] ^ 4]) + data[at + 1 :]
        with suppress(MapError):
            assert decode_stops(flipped) == stops, at


def content(**changes: Any) -> bytes:
    """Return the file of two stops with a few things otherwise, and right sums; changes of None leave things out."""
    plain = msgspec.msgpack.decode(zlib.decompress(encode_stops(made_stops(1)).removeprefix(HEAD)))
    for name, value in changes.items():
        inner = plain if name in plain else plain["columns"]
        inner[name] = value
        if value is None:
            del inner[name]
    return HEAD + zlib.compress(msgspec.msgpack.encode(plain))


def doubles(*numbers: float) -> bytes:
    """Return a column of float64."""
    return np.array(numbers, "<f8").tobytes()


def test_the_column_of_this_test_is_that_of_the_file() -> None:
    here = made_stops(1).stops
    assert decode_stops(content(in_map=doubles(*[4.0] * 6))).stops[1] == MapStop.of(here[1].sweep, Pose2(4.0, 4.0, 4.0))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"numbers": b""}, "numbers: expected 2 numbers of 8 bytes, got 0"),
        ({"counts": b"\0\0\0"}, "counts: expected whole numbers of 4 bytes, got 3 bytes"),
        ({"counts": b""}, "numbers: expected 0 numbers"),
        ({"counts": b"\x0c\0\0\0\x0d\0\0\0"}, "origins_m: expected 50 numbers"),
        (
            {"counts": b"\xff" * 8},
            f"expected at most {STOPS_MAX} stops of {READINGS_MAX} readings, got 2 of 8589934590",
        ),
        ({"counts": bytes(4 * (STOPS_MAX + 1))}, f"got {STOPS_MAX + 1} of 0"),
        ({"in_map": doubles(*[math.nan] * 6)}, "in_map: expected finite numbers"),
        ({"in_odom": doubles(*[math.inf] * 6)}, "in_odom: expected finite numbers"),
        ({"bearings_rad": doubles(*[1e300] * 24)}, "bearings_rad: expected finite numbers up to"),
        ({"origins_m": doubles(*[-1e7] * 48)}, "origins_m: expected finite"),
        ({"ranges_m": doubles(*[0.0] * 24)}, "ranges_m: expected positive ones"),
        ({"ranges_m": doubles(*[-1.0] * 24)}, "ranges_m: expected positive ones"),
        ({"states": b"\xff" * 24}, "states: expected less than 9, got 255"),
        ({"statuses": ["ok"]}, "states: expected less than 1"),
        ({"statuses": ["ok", "dancing"]}, "dancing"),
        ({"strong": bytes(23)}, "strong: expected 24 numbers of 1 bytes"),
        ({"times_ns": 5}, "Expected `bytes`"),
        ({"settings": {"raise_alpha": 7.0}}, "raise_alpha"),
        ({"settings": []}, "Expected `object`"),
        ({"settings": {"dancing": True}}, "which this version does not know"),
        ({"arithmetic": "a" * 17}, "length <= 16"),
        ({"arithmetic": None}, "missing required field `arithmetic`"),
        ({"columns": None}, "missing required field `columns`"),
        ({"numbers": None}, "missing required field `numbers`"),
    ],
    ids=range(24),
)
def test_what_no_store_wrote_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(MapError, match=says):
        decode_stops(content(**changes))


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "does not begin with"),
        (b"PK\x03\x04\n", "does not begin with"),
        (b"robotd stops 1", "does not begin with"),
        (b"robotd stops 3\n", "format '3', this version reads formats 1 and 2"),
        (b"robotd stops " + b"9" * 4000 + b"\n", "format '99999999999999999999',"),
        (HEAD, "expected the end of its zlib"),
        (HEAD + b"not zlib", "incorrect header"),
        (HEAD + zlib.compress(b""), "truncated"),
        (HEAD + zlib.compress(b"\x91" * 100_000), "Expected `object`|recursion"),
        (HEAD + zlib.compress(b"\xc1"), "malformed"),
    ],
    ids=range(10),
)
def test_what_is_another_file_is_refused(data: bytes, says: str) -> None:
    with pytest.raises(MapError, match=says):
        decode_stops(data)


def test_settings_that_came_later_are_what_they_were_before_they_came() -> None:
    """A setting that is added belongs into ``SETTINGS_SINCE``: by its default old stops may come to another grid."""
    first = {"resolution_m", "rows", "cols", "raise_alpha", "lower_alpha", "policy", "over_range"}
    assert {field.name for field in dataclasses.fields(GridSettings)} == first | SETTINGS_SINCE.keys()
    old = {name: value for name, value in dataclasses.asdict(GridSettings()).items() if name in first}
    assert decode_stops(content(settings=old)).settings == dataclasses.replace(GridSettings(), **SETTINGS_SINCE)


def test_a_bomb_takes_no_more_memory_than_stated() -> None:
    squeezing = zlib.compressobj(9)
    bomb = HEAD + b"".join(squeezing.compress(bytes(1 << 20)) for _ in range(256)) + squeezing.flush()
    tracemalloc.start()
    try:
        with pytest.raises(MapError, match="expected the end of its zlib"):
            decode_stops(bomb)
        assert tracemalloc.get_traced_memory()[1] < 72 << 20
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("reading", "says"),
    [
        (RangeReading(0, math.nan, ReadingStatus.OK, 1.0), "bearings_rad: expected finite"),
        (RangeReading(0, 0.0, ReadingStatus.OK, 1e9), "ranges_m: expected finite"),
    ],
)
def test_what_could_not_be_read_again_is_not_written(reading: RangeReading, says: str) -> None:
    with pytest.raises(MapError, match=says):
        encode_stops(MapStops(GridSettings(), (MapStop.of(Sweep(0, IDENTITY, (reading,)), IDENTITY),)))


def test_more_readings_than_can_be_read_are_not_written() -> None:
    reading = RangeReading(0, 0.0, ReadingStatus.OK, 1.0)
    sweep = Sweep(0, IDENTITY, (reading,) * (1 << 15))
    with pytest.raises(MapError, match="expected at most"):
        encode_stops(MapStops(GridSettings(), (MapStop.of(sweep, IDENTITY),) * 17))
