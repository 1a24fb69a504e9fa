"""What clients send is never trusted, and always answered."""

import math
import tracemalloc
from typing import Any

import msgpack
import msgspec
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from robotd.contract.answers import ErrorCode, MissionStarted
from robotd.contract.area import Area
from robotd.contract.envelope import (
    BadRequest,
    NumberedRequest,
    decode_reply,
    decode_request,
    encode_error,
    encode_request,
    encode_result,
)
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart, Mission, PriorHeading, with_lease
from robotd.contract.request import Request
from robotd.contract.requests import (
    REQUESTS,
    Arm,
    GetStatus,
    MapLoad,
    MapShow,
)
from robotd.core.errors import RemoteProtocolError, ServerError
from robotd.core.pose import Pose2
from tests.unit.contract.messages import LIMIT, golden_request

SAMPLES: list[Request[Any]] = [
    *map(golden_request, REQUESTS),
    MapStart("lab-2"),
    Localize(),
    DriveTo(1.5, -2.5),
    MapLoad("a"),
    MapShow(),
]


def request(**fields: Any) -> bytes:
    packed: bytes = msgpack.packb({"v": 1, "id": 5, "cmd": "drive_to", "args": {"x_m": 1.0, "y_m": 2.0}} | fields)
    return packed


@pytest.mark.parametrize("command", SAMPLES, ids=lambda command: command.cmd)
def test_a_command_survives_the_way(command: Request[Any]) -> None:
    assert decode_request(encode_request(12, command), LIMIT) == NumberedRequest(12, command)


@pytest.mark.parametrize(
    "mission",
    [
        MapStart.of("a", ((1.0, 2.0),), Pose2(1.0, 2.0, 3.0), Legs.STRAIGHT),
        Localize(0.5),
        Localize(),
        Localize(heading=PriorHeading.UNKNOWN, within=Area(1.0, -2.0, 0.5)),
        DriveTo(1.0, 2.0, Legs.STRAIGHT),
    ],
)
def test_a_mission_survives_the_way(mission: Mission) -> None:
    decoded = decode_request(encode_request(1, with_lease(mission, 0.5)), LIMIT)
    assert isinstance(decoded, NumberedRequest)
    assert isinstance(decoded.request, Mission)
    assert (decoded.request.lease_s, mission.lease_s) == (0.5, None)
    assert msgspec.structs.replace(decoded.request, lease_s=None) == mission


def test_who_asks_goes_along_if_it_is_said() -> None:
    assert decode_request(encode_request(7, Arm(), "anna"), LIMIT) == NumberedRequest(7, Arm(), "anna")
    assert b"client" not in encode_request(7, Arm())
    named = decode_request(encode_request(7, Arm(), "anna\n"), LIMIT)
    assert isinstance(named, NumberedRequest)
    assert named.client == r"anna\n"


@pytest.mark.parametrize("client", ["x" * 65, 7, b"anna", ["anna"]])
def test_a_name_that_is_none_is_refused(client: object) -> None:
    refused = decode_request(request(client=client), LIMIT)
    assert isinstance(refused, BadRequest)
    assert refused.error.code in {"bad_argument", "malformed"}


def test_whole_numbers_do_for_metres() -> None:
    decoded = decode_request(request(args={"x_m": 1, "y_m": 2}), LIMIT)
    assert isinstance(decoded, NumberedRequest)
    assert decoded.request == DriveTo(1.0, 2.0)


def test_arguments_may_be_left_out_where_there_are_none() -> None:
    assert decode_request(msgpack.packb({"v": 1, "id": 0, "cmd": "status"}), LIMIT) == NumberedRequest(0, GetStatus())


DUPLICATE = b"\x84\xa1v\x01\xa2id\x05\xa3cmd\xa4stop\xa3cmd\xa3arm"
BAD = {
    "nothing": (b"", "malformed"),
    "not msgpack": (b"GET / HTTP/1.1\r\n\r\n", "malformed"),
    "not a map": (msgpack.packb([1, 2]), "malformed"),
    "empty map": (b"\x80", "unsupported_version"),
    "trailing bytes": (request() + b"\xc0", "malformed"),
    "cut": (request()[:-3], "malformed"),
    "duplicate key": (DUPLICATE, "malformed"),
    "key that is no string": (msgpack.packb({1: 2}), "malformed"),
    "bad utf-8": (b"\x81\xa1\xff\x01", "malformed"),
    "bytes": (request(args={"x_m": 1.0, "y_m": b"x"}), "bad_argument"),
    "extension type": (request(args={"x_m": msgpack.Timestamp(1), "y_m": 1.0}), "malformed"),
    "nesting bomb": (b"\x91" * 60000 + b"\xc0", "malformed"),
    "nested seven deep": (request(args={"x_m": [[[[[[1]]]]]]}), "malformed"),
    "array bomb": (b"\xdd\xff\xff\xff\xff", "malformed"),
    "map bomb": (b"\xdf\xff\xff\xff\xff", "malformed"),
    "string bomb": (b"\xdb\xff\xff\xff\xff", "malformed"),
    "too many keys": (msgpack.packb({str(key): 0 for key in range(65)}), "malformed"),
    "too large": (request(args={"name": "x" * LIMIT}), "too_large"),
    "no id": (msgpack.packb({"v": 1, "cmd": "stop"}), "malformed"),
    "id of letters": (request(id="5"), "malformed"),
    "id below zero": (request(id=-1), "malformed"),
    "id true": (request(id=True), "malformed"),
    "id too great": (request(id=2**63), "malformed"),
    "unknown key": (request(extra=1), "malformed"),
    "unknown keys of two kinds": (msgpack.packb({"v": 1, "id": 5, b"": 1, "zz": 2}), "malformed"),
    "version 2": (request(v=2), "unsupported_version"),
    "version 1.0": (request(v=1.0), "unsupported_version"),
    "version true": (request(v=True), "unsupported_version"),
    "unknown command": (request(cmd="fly"), "unknown_command"),
    "command that is a list": (request(cmd=["stop"]), "unknown_command"),
    "arguments that are a list": (request(args=[1.0, 2.0]), "bad_argument"),
    "unknown argument": (request(args={"x_m": 1.0, "y_m": 2.0, "z_m": 3.0}), "bad_argument"),
    "missing argument": (request(args={"x_m": 1.0}), "bad_argument"),
    "number as text": (request(args={"x_m": "1", "y_m": 2.0}), "bad_argument"),
    "number as truth": (request(args={"x_m": True, "y_m": 2.0}), "bad_argument"),
    "nan": (request(args={"x_m": math.nan, "y_m": 2.0}), "bad_argument"),
    "infinity": (request(args={"x_m": math.inf, "y_m": 2.0}), "bad_argument"),
    "out of this world": (request(args={"x_m": 1e9, "y_m": 2.0}), "bad_argument"),
    "integer no float holds": (request(args={"x_m": 2**64 - 1, "y_m": 2.0}), "bad_argument"),
    "lease too short": (request(args={"x_m": 1.0, "y_m": 2.0, "lease_s": 0.01}), "bad_argument"),
    "lease too long": (request(args={"x_m": 1.0, "y_m": 2.0, "lease_s": 60}), "bad_argument"),
    "unknown legs": (request(args={"x_m": 1.0, "y_m": 2.0, "legs": "flying"}), "bad_argument"),
    "name that climbs": (request(cmd="map_load", args={"name": "../etc"}), "bad_argument"),
    "name with newline": (request(cmd="map_load", args={"name": "a\n"}), "bad_argument"),
    "version below zero": (request(cmd="map_load", args={"name": "a", "version": -1}), "bad_argument"),
    "stop of three numbers": (request(cmd="map_start", args={"name": "a", "stops_m": [[1, 2, 3]]}), "bad_argument"),
    "too many stops": (request(cmd="map_start", args={"name": "a", "stops_m": [[1, 2]] * 1001}), "bad_argument"),
    "heading in degrees": (request(cmd="localize", args={"heading_rad": 90.0}), "bad_argument"),
    "path with zero": (request(cmd="record_start", args={"path": "a\0b"}), "bad_argument"),
}


@pytest.mark.parametrize(("data", "code"), BAD.values(), ids=BAD.keys())
def test_a_bad_request_is_named(data: bytes, code: str) -> None:
    decoded = decode_request(data, LIMIT)
    assert isinstance(decoded, BadRequest)
    assert (decoded.error.code, bool(decoded.error.message)) == (code, True)
    reply = decode_reply(encode_error(decoded.id, decoded.error))
    assert isinstance(reply.result, ServerError)
    assert (reply.id, reply.result.code) == (decoded.id, code)


@pytest.mark.parametrize(
    "fields",
    [
        {"cmd": "\x1b[2J\n" + "x" * 50_000},
        {"v": "\x1b[2J\n" + "x" * 50_000},
        {"\x1b[2J\n" + "x" * 50_000: 1},
        {"args": {"\x1b[2J\n" + "x" * 50_000: 1}},
    ],
)
def test_what_an_error_quotes_is_printable_and_short(fields: dict[str, Any]) -> None:
    decoded = decode_request(request(**fields), LIMIT)
    assert isinstance(decoded, BadRequest)
    reply = decode_reply(encode_error(decoded.id, decoded.error)).result
    assert isinstance(reply, ServerError)
    assert reply.message.isprintable()
    assert len(reply.message) <= 1000


def test_a_bad_argument_is_answered_under_its_number() -> None:
    decoded = decode_request(request(args={"x_m": math.nan, "y_m": 1.0}), LIMIT)
    assert isinstance(decoded, BadRequest)
    assert decoded.id == 5


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"args": {"x_m": 1.0, "y_m": "2"}}, "drive_to: y_m: Expected `float`, got `str`"),
        ({"args": {"x_m": 1.0}}, "drive_to: Object missing required field `y_m`"),
        (
            {"cmd": "map_start", "args": {"name": "a", "stops_m": [[1, 2], [1, 1e6]]}},
            "map_start: stops_m[1][1]: Expected `float` <= 100000.0",
        ),
        (
            {"cmd": "map_start", "args": {"name": "a", "start": {"x_m": 0, "y_m": 0, "heading_rad": 90}}},
            "map_start: start.heading_rad: Expected `float` <= 6.283185307179586",
        ),
    ],
)
def test_a_bad_argument_is_called_by_its_name(fields: dict[str, Any], message: str) -> None:
    decoded = decode_request(request(**fields), LIMIT)
    assert isinstance(decoded, BadRequest)
    assert decoded.error.message == message


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text(max_size=20) | st.binary(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=20,
)
KEYS = st.sampled_from(["v", "id", "cmd", "args", "zz"]) | st.text(max_size=3) | st.binary(max_size=2)
NAMES = st.sampled_from([*REQUESTS, "fly"])
FIELDS = st.sampled_from(["x_m", "y_m", "name", "lease_s", "heading_rad", "mission_id", "stops_m", "start", "reason"])


@given(st.binary(max_size=200))
@example(b"\xc1")
@settings(max_examples=150)
def test_no_bytes_raise(data: bytes) -> None:
    assert isinstance(decode_request(data, LIMIT), NumberedRequest | BadRequest)


@given(st.dictionaries(KEYS, st.just(1) | NAMES | VALUES, max_size=6))
@settings(max_examples=150)
def test_no_map_raises(fields: dict[Any, Any]) -> None:
    assert isinstance(decode_request(msgpack.packb(fields), LIMIT), NumberedRequest | BadRequest)


@given(NAMES, st.dictionaries(FIELDS, VALUES, max_size=4), st.just(1) | VALUES, st.integers(0, 9) | VALUES)
@settings(max_examples=150)
def test_no_arguments_raise_and_none_that_pass_are_infinite(
    name: str, args: dict[str, Any], version: Any, number: Any
) -> None:
    decoded = decode_request(msgpack.packb({"v": version, "id": number, "cmd": name, "args": args}), LIMIT)
    assert isinstance(decoded, NumberedRequest | BadRequest)
    if isinstance(decoded, NumberedRequest):
        assert "nan" not in repr(decoded.request)
        assert "inf" not in repr(decoded.request).replace("reason='", "")


@given(st.sampled_from(SAMPLES), st.integers(0, 10_000), st.integers(0, 255))
@settings(max_examples=150)
def test_no_altered_request_raises(command: Request[Any], at: int, byte: int) -> None:
    data = bytearray(encode_request(3, command))
    data[at % len(data)] = byte
    assert isinstance(decode_request(bytes(data), LIMIT), NumberedRequest | BadRequest)


def test_a_bomb_costs_little_memory() -> None:
    bomb = msgpack.packb({"v": 1, "id": 1, "cmd": "stop", "args": {"a": [[]] * 2048, "b": [[[]] * 2048] * 2000}})
    tracemalloc.start()
    for data in (bomb[:LIMIT], b"\xdd\x00\xff\xff\xff" + b"\x90" * 60000, b"\x91" * LIMIT):
        assert isinstance(decode_request(data, LIMIT), BadRequest)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 100 * LIMIT


def test_a_result_survives_the_way() -> None:
    reply = decode_reply(encode_result(3, MissionStarted(4, 0.5)))
    assert (reply.id, reply.result) == (3, {"mission_id": 4, "lease_s": 0.5})


@pytest.mark.parametrize("data", [b"", b"\xc0", b"\x80", msgpack.packb({"v": 2, "id": 1, "ok": True, "result": {}})])
def test_what_is_no_reply_is_the_servers_fault(data: bytes) -> None:
    with pytest.raises(RemoteProtocolError):
        decode_reply(data)


def numbers_in(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return where the numbers are in the arguments of a request."""
    if isinstance(value, dict):
        return [place for key, item in value.items() for place in numbers_in(item, (*path, key))]
    if isinstance(value, list):
        return [place for index, item in enumerate(value) for place in numbers_in(item, (*path, index))]
    return [path] if type(value) in {int, float} else []


BOUNDED = [
    *SAMPLES,
    Localize(within=Area(1.0, 2.0, 3.0), heading_rad=0.5, lease_s=1.0),
    DriveTo(1.0, 2.0, lease_s=1.0),
]
NUMBERS = [
    (command.cmd, place, msgpack.unpackb(encode_request(5, command)))
    for command in BOUNDED
    for place in numbers_in(msgpack.unpackb(encode_request(5, command))["args"])
]


def test_there_are_numbers_to_try() -> None:
    assert {cmd for cmd, _, _ in NUMBERS} >= {
        "map_start",
        "localize",
        "drive_to",
        "drive",
        "turn",
        "renew",
        "map_load",
        "map_show",
    }


@pytest.mark.parametrize("absurd", [math.nan, math.inf, -math.inf, 1e300, -1e6, 2**63])
@pytest.mark.parametrize(
    ("cmd", "place", "fields"), NUMBERS, ids=lambda value: "".join(map(str, value)) if isinstance(value, tuple) else ""
)
def test_every_number_of_every_request_has_bounds(cmd: str, place: tuple[Any, ...], fields: Any, absurd: float) -> None:
    fields = msgpack.unpackb(msgpack.packb(fields))  # a copy to change
    inner = fields["args"]
    for step in place[:-1]:
        inner = inner[step]
    inner[place[-1]] = absurd
    answer = decode_request(msgpack.packb(fields), LIMIT)
    assert isinstance(answer, BadRequest)
    assert answer.error.code == ErrorCode.BAD_ARGUMENT
    if math.isfinite(absurd):  # what is no number is refused before anybody asks whose argument it is
        assert answer.error.message.startswith(f"{cmd}: {place[0]}")
