"""What is taken for a stop, and what is not."""

from typing import Any

import msgpack
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from robotd.contract.envelope import BadRequest, NumberedRequest, decode_request, encode_request
from robotd.contract.missions import Localize
from robotd.contract.request import Request
from robotd.contract.requests import LONGEST_REASON, Arm, Disarm, Hello, MapSave, RecordStop, Stop
from robotd.contract.stopping import STOPPING, means_stop
from tests.unit.contract.test_envelope import SAMPLES

LIMIT = 65536
STOP = encode_request(5, Stop("because"))
OTHERS = [sample for sample in SAMPLES if not isinstance(sample, STOPPING)]


def stops(data: bytes) -> bool:
    """Whether a request, good or bad, stops the robot."""
    decoded = decode_request(data, LIMIT)
    return decoded.means_stop if isinstance(decoded, BadRequest) else isinstance(decoded.request, STOPPING)


RECOGNIZED: dict[str, bytes] = {
    "nothing but the word": b"stop",
    "the word, typed": b"STOP\n",
    "the word in msgpack": msgpack.packb("stop"),
    "a list": msgpack.packb(["stop"]),
    "a list like a call": msgpack.packb([1, 5, "stop", {}]),
    "a list for a command": msgpack.packb({"v": 1, "id": 5, "cmd": ["stop"]}),
    "a map for a command": msgpack.packb({"v": 1, "id": 5, "cmd": {"stop": {}}}),
    "the command as a key": msgpack.packb({"v": 1, "id": 5, "stop": {"reason": "x"}}),
    "another key": msgpack.packb({"v": 1, "id": 5, "command": "stop"}),
    "a key in capitals": msgpack.packb({"V": 1, "ID": 5, "CMD": "Stop"}),
    "blanks": msgpack.packb({"v": 1, "id": 5, "cmd": " stop "}),
    "bytes": msgpack.packb({b"v": 1, b"id": 5, b"cmd": b"stop"}),
    "many words": msgpack.packb({"v": 1, "id": 5, "cmd": "emergency_stop"}),
    "one letter wrong": msgpack.packb({"v": 1, "id": 5, "cmd": "stpp"}),
    "twice, with another": b"\x84\xa1v\x01\xa2id\x05\xa3cmd\xa4stop\xa3cmd\xa3arm",
    "JSON": b'{"v": 1, "id": 5, "cmd": "stop", "args": {}}',
    "JSON, pretty": b'{\n  "cmd" :\n    "STOP"\n}',
    "JSON of wide letters": '{"cmd": "stop"}'.encode("utf-16"),
    "JSON in msgpack": msgpack.packb('{"cmd": "stop"}'),
    "HTTP": b"POST /stop HTTP/1.1\r\n\r\n",
    "YAML": b"cmd: stop\n",
    "too deep": msgpack.packb({"v": 1, "id": 5, "cmd": "stop", "args": {"reason": [[[[[[[[1]]]]]]]]}}),
    "too large": msgpack.packb({"v": 1, "id": 5, "cmd": "stop", "args": {"trace": "y" * 200_000}}),
    "a bomb behind it": STOP[:-9] + b"\x91" * 60_000,
    "a disarm of another version": msgpack.packb({"v": 9, "id": 5, "cmd": "disarm", "args": {}}),
}


@pytest.mark.parametrize("data", RECOGNIZED.values(), ids=RECOGNIZED.keys())
def test_what_is_taken_for_a_stop(data: bytes) -> None:
    assert stops(data)


NOT_RECOGNIZED: dict[str, bytes] = {
    "nothing": b"",
    "noise": bytes(range(256)),
    "a map called stop": msgpack.packb({"v": 2, "id": 5, "cmd": "map_load", "args": {"name": "stop"}}),
    "an argument called stop": msgpack.packb({"v": 1, "id": 5, "cmd": "arm", "args": {"stop": True}}),
    "the end of a recording": msgpack.packb({"v": 2, "id": 5, "cmd": "record_stop", "args": {}}),
    "the end of a recording, misspelt": msgpack.packb({"v": 1, "id": 5, "cmd": "stop_record", "args": {}}),
    "JSON of another command": b'{"v": 1, "id": 5, "cmd": "map_load", "args": {"name": "stop"}}',
    "stops of a map, in JSON": b'{"v": 1, "cmd": "map_start", "args": {"name": "a", "stops_m": [[1, 2]]}}',
    "a letter more": msgpack.packb({"v": 1, "id": 5, "cmd": "status", "args": {"reason": "stop"}}),
    "the start of a status": b'{"cmd": "st',
}


@pytest.mark.parametrize("data", NOT_RECOGNIZED.values(), ids=NOT_RECOGNIZED.keys())
def test_what_is_not_taken_for_a_stop(data: bytes) -> None:
    assert not stops(data)


@pytest.mark.parametrize("at", range(len(STOP)))
def test_a_stop_with_any_one_byte_wrong_is_obeyed(at: int) -> None:
    damaged = (STOP[:at] + bytes((byte,)) + STOP[at + 1 :] for byte in range(256))
    assert [data for data in damaged if not stops(data)] == []


@pytest.mark.parametrize("at", [at for at in range(len(STOP)) if not 0 < at - STOP.index(b"stop") < len("stop")])
def test_a_stop_with_a_byte_too_many_or_too_few_beside_the_word_is_obeyed(at: int) -> None:
    damaged = [STOP[:at] + bytes((byte,)) + STOP[at:] for byte in range(256)]
    if STOP[at : at + 4] != b"stop":
        damaged.append(STOP[:at] + STOP[at + 1 :])
    assert [data for data in damaged if not stops(data)] == []


@given(st.integers(STOP.index(b"stop") + 3, len(STOP)), st.binary(max_size=20))
@settings(max_examples=200)
def test_a_stop_that_was_cut_or_goes_on_is_obeyed(length: int, more: bytes) -> None:
    assert stops(STOP[:length])
    assert stops(STOP + more)


VALUES = st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text() | st.binary()


@given(
    fields=st.dictionaries(st.sampled_from(["v", "id", "args", "extra", "urgent"]), VALUES | st.lists(VALUES)),
    name=st.sampled_from(["stop", "STOP", "Stop ", b"stop"]),
)
@settings(max_examples=300)
@example(fields={"args": {"reason": float("nan")}}, name="stop")
def test_a_stop_with_anything_beside_it_is_obeyed(fields: dict[str, Any], name: str | bytes) -> None:
    assert stops(msgpack.packb({"cmd": name} | fields))
    assert stops(msgpack.packb(fields | {"cmd": name}))


@given(reason=VALUES | st.lists(VALUES, max_size=3), number=st.integers(0, 2**63 - 1))
@settings(max_examples=300)
@example(reason="x" * 201, number=0)
@example(reason="\x1b[2J\nforged", number=0)
@example(reason="", number=0)
def test_a_stop_whose_reason_alone_is_odd_is_a_good_request(reason: Any, number: int) -> None:
    decoded = decode_request(msgpack.packb({"v": 1, "id": number, "cmd": "stop", "args": {"reason": reason}}), LIMIT)
    assert isinstance(decoded, NumberedRequest)
    assert isinstance(decoded.request, Stop)
    assert decoded.id == number
    assert decoded.request.reason.isprintable()
    assert 0 < len(decoded.request.reason) <= LONGEST_REASON


@given(st.sampled_from(OTHERS), st.data())
@settings(max_examples=300)
def test_another_request_never_stops_whole_or_cut_behind_its_command(
    command: Request[Any], data: st.DataObject
) -> None:
    packed = encode_request(5, command)
    name_ends = packed.index(command.cmd.encode()) + len(command.cmd)
    assert not stops(packed)
    assert not stops(packed[: data.draw(st.integers(name_ends, len(packed)))])
    assert not stops(packed + data.draw(st.binary(max_size=8)).replace(b"p", b""))


@given(
    st.sampled_from(["stop", "disarm", "cmd stop", '"cmd":"disarm"']),
    st.sampled_from(["map_load", "map_show", "map_save"]),
)
def test_a_name_never_stops(name: str, command: str) -> None:
    for version in (1, 2):
        assert not stops(msgpack.packb({"v": version, "id": 5, "cmd": command, "args": {"name": name}}))


@given(st.binary(max_size=300))
@settings(max_examples=300)
def test_no_bytes_raise(data: bytes) -> None:
    assert isinstance(means_stop(data), bool)
    assert isinstance(means_stop(b"\xa3cmd" + data), bool)


@pytest.mark.parametrize("args", [None, [], {}])
@pytest.mark.parametrize("command", [Hello, Arm, Localize, MapSave, RecordStop, Stop, Disarm])
def test_an_empty_list_and_nil_are_no_arguments(command: type[Request[Any]], args: Any) -> None:
    packed = msgpack.packb({"v": 1, "id": 5, "cmd": command.cmd, "args": args})
    assert decode_request(packed, LIMIT) == NumberedRequest(5, command())


@pytest.mark.parametrize("args", [0, "", False, [1], "none"])
def test_nothing_else_is_taken_for_no_arguments(args: Any) -> None:
    assert isinstance(decode_request(msgpack.packb({"v": 1, "id": 5, "cmd": "arm", "args": args}), LIMIT), BadRequest)


@pytest.mark.parametrize(
    ("reason", "kept"),
    [
        ("", "stopped by a client"),
        (" \t", " \\t"),
        ("x" * 50_000, "x" * 197 + "..."),
        ("a\nb", "a\\nb"),
        ("half \ud800", "half \\ud800"),
        (ValueError("wheel"), "wheel"),
        (b"caf\xc3\xa9 \xff", "café \\xff"),
        (None, "stopped by a client"),
    ],
)
def test_a_client_stops_for_any_reason(reason: object, kept: str) -> None:
    assert Stop.because(reason).reason == kept
    assert decode_request(encode_request(1, Stop.because(reason)), LIMIT) == NumberedRequest(1, Stop(kept))
