"""Messages with right sums that no daemon wrote are refused by their channel, before anything is made of them."""

import json
from typing import Any

import pytest

from robotd.core.errors import RecordingError
from robotd.recording.encoding import decode, decode_header

HEADER = {"robotd_version": "1", "config_text": "", "session_seed": 1, "wall_offset_ns": 0, "started_ns": 0}
DEEP = b'{"name":' + b"[" * 100_000 + b"]" * 100_000 + b"}"


@pytest.mark.parametrize(
    "data",
    [
        b"[]",
        b"5",
        b"null",
        b"{}",
        DEEP,
        json.dumps(HEADER | {"started_ns": "now"}).encode(),
        json.dumps(HEADER | {"started_ns": -1}).encode(),
        json.dumps(HEADER | {"started_ns": 10**30}).encode(),
        json.dumps(HEADER | {"config_text": 5}).encode(),
        json.dumps(HEADER | {"session_seed": None}).encode(),
        json.dumps(HEADER | {"more": 1}).encode(),
    ],
    ids=range(11),
)
def test_a_header_that_is_none_is_refused(data: bytes) -> None:
    with pytest.raises(RecordingError, match="header"):
        decode_header(data)


@pytest.mark.parametrize(
    ("topic", "content"),
    [
        ("command", []),
        ("command", {"name": 5, "arguments": {}}),
        ("command", {"name": "arm", "arguments": []}),
        ("command", {"name": "arm"}),
        ("command", {"name": "arm", "arguments": {}, "encoded": "x"}),
        ("command", {"name": "arm", "arguments": {}, "time_ns": 5, "more": 1}),
        ("computed", {"name": "a", "index": "0"}),
        ("computed", {"name": ["a"], "index": 0}),
        ("cause", {"name": "stall"}),
        ("result", {"kind": "map", "content": 5, "digest": ""}),
        ("result", {"kind": ["map"], "content": {}, "digest": ""}),
        ("result", {"kind": "map", "content": {}, "digest": None}),
        ("line/drive", {"up": "yes"}),
        ("line/drive", {"up": 1}),
        ("line/drive", None),
    ],
)
def test_a_message_that_does_not_fit_its_channel_is_refused(topic: str, content: Any) -> None:
    with pytest.raises(RecordingError, match=topic):
        decode(topic, 0, json.dumps(content).encode())


@pytest.mark.parametrize(("topic", "data"), [("command", DEEP), ("result", b"\xff"), ("serial/drive/up", b"")])
def test_bytes_that_are_no_message_are_refused(topic: str, data: bytes) -> None:
    with pytest.raises(RecordingError, match=topic):
        decode(topic, 0, data)


def test_a_time_that_no_clock_shows_is_refused() -> None:
    with pytest.raises(RecordingError, match="clock"):
        decode("serial/drive/from_board", 2**64 - 1, b"")


@pytest.mark.parametrize("half", [b"\\ud800", b"\\uD800", b"\xed\xa0\x80"])
def test_half_a_letter_is_refused_wherever_it_is_and_a_whole_one_is_not(half: bytes) -> None:
    with pytest.raises(RecordingError, match="result"):
        decode("result", 0, b'{"kind":"map","content":{},"digest":"' + half + b'"}')
    with pytest.raises(RecordingError, match="command"):
        decode("command", 0, b'{"name":"stop","arguments":{"' + half + b'":1}}')
    with pytest.raises(RecordingError, match="header"):
        decode_header(json.dumps(HEADER).encode().replace(b'"config_text": ""', b'"config_text": "' + half + b'"'))
    whole = decode("command", 0, json.dumps({"name": "stop", "arguments": {"reason": "\N{ROBOT FACE}"}}).encode())
    assert getattr(whole, "arguments", None) == {"reason": "\N{ROBOT FACE}"}
