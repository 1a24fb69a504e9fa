"""A golden file for each message, so that renaming a field, a word or a command cannot break a client unseen.

Each file in ``golden/`` is a request with its reply, or an event, of wire version 1: as other languages see it, in the
order of its bytes. Every message must be understood, and come out of us again byte for byte. What stands there is a
promise: a file may be added, but never changed (a new optional field of a reply or an event is added to its file).
"""

import json
import zlib
from enum import StrEnum
from typing import Any

import msgpack
import msgspec
import pytest

from robotd.contract.answers import ErrorCode
from robotd.contract.device_status import LinkState
from robotd.contract.envelope import (
    NumberedRequest,
    decode_reply,
    decode_request,
    encode_error,
    encode_request,
    encode_result,
)
from robotd.contract.estimate import Contradiction, PoseState
from robotd.contract.events import MissionPhase
from robotd.contract.missions import Legs, PriorHeading
from robotd.contract.modes import MODE_WORDS
from robotd.contract.plain import from_plain
from robotd.contract.requests import REQUESTS
from robotd.contract.topics import EVENTS, Frame, Topic, encode_frame, to_wire
from robotd.contract.ways import Hindrance, StopState
from robotd.core.errors import ServerError
from robotd.core.reading import ReadingStatus
from tests.unit.contract.messages import GOLDEN, LIMIT, golden_request, message, names, packed

WORDS: list[type[StrEnum]] = [
    PoseState,
    Contradiction,
    MissionPhase,
    Legs,
    PriorHeading,
    LinkState,
    ReadingStatus,
    ErrorCode,
    Topic,
    Hindrance,
    StopState,
]


def inflated(data: bytes) -> Any:
    """A message with its cells as they are: how they were squeezed is no promise, that they come out is."""
    return _inflated(msgpack.unpackb(data))


def _inflated(fields: Any) -> Any:
    if not isinstance(fields, dict):
        return fields
    return {
        key: zlib.decompress(value) if key == "cells_zlib" and value else _inflated(value)
        for key, value in fields.items()
    }


def in_order(fields: Any) -> Any:
    """A message whose maps compare by the order of their keys, too."""
    return [(key, in_order(value)) for key, value in fields.items()] if isinstance(fields, dict) else fields


def test_every_message_has_its_file_and_no_other() -> None:
    assert set(names("exchanges")) == set(REQUESTS)
    assert set(names("events")) == {*(name for _, name in EVENTS.values()), "map_changed_whole"}


@pytest.mark.parametrize("name", names("exchanges"))
def test_a_request_is_understood_and_sent_byte_for_byte(name: str) -> None:
    data = packed(message(f"exchanges/{name}")["request"])
    request = decode_request(data, LIMIT)
    assert isinstance(request, NumberedRequest)
    assert type(request.request) is REQUESTS[name]
    assert encode_request(request.id, request.request) == data


@pytest.mark.parametrize("name", names("exchanges"))
def test_a_request_shows_every_argument_at_another_value_than_its_own(name: str) -> None:
    arguments = message(f"exchanges/{name}")["request"]["args"]
    fields = msgspec.structs.fields(REQUESTS[name])
    assert list(arguments) == [field.name for field in fields]
    shown = golden_request(name)
    at_their_own = {field.name for field in fields if getattr(shown, field.name) == field.default}
    # Which must be the usual one where heading_rad is given; and an adaptive look has no layers.
    assert at_their_own <= {"heading", "layers"}


@pytest.mark.parametrize("name", names("exchanges"))
def test_a_reply_is_understood_and_given_byte_for_byte(name: str) -> None:
    data = packed(message(f"exchanges/{name}")["reply"])
    reply = decode_reply(data)
    assert reply.id is not None
    result = from_plain(REQUESTS[name].result, reply.result)
    assert in_order(inflated(encode_result(reply.id, result))) == in_order(inflated(data))


def test_a_refusal_is_understood_and_given_byte_for_byte() -> None:
    data = packed(message("refusal"))
    reply = decode_reply(data)
    assert isinstance(reply.result, ServerError)
    assert encode_error(reply.id, reply.result) == data


@pytest.mark.parametrize("name", names("events"))
def test_an_event_is_understood_and_published_byte_for_byte(name: str) -> None:
    fields = message(f"events/{name}")
    (topic,) = {topic for topic, kind in EVENTS.values() if kind == fields["event"]}
    heard = Frame.of(topic.prefix + packed(fields))
    assert heard.published is not None
    frame = encode_frame(topic, heard.session, heard.seq, to_wire(heard.published)[1])
    assert frame.startswith(topic.prefix)
    assert in_order(inflated(frame.removeprefix(topic.prefix))) == in_order(inflated(packed(fields)))


@pytest.mark.parametrize("path", [f"{family}/{name}" for family in ("exchanges", "events") for name in names(family)])
def test_nothing_in_a_file_is_left_open(path: str) -> None:
    """A null or an empty list shows no names: what could stand there would be free to change."""
    assert list(_open_places(message(path))) == []


def _open_places(value: Any, at: str = "") -> Any:
    if value is None or value == []:
        yield at
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield from _open_places(item, f"{at}.{key}")


@pytest.mark.parametrize("kind", WORDS, ids=lambda kind: kind.__name__)
def test_words_stay(kind: type[StrEnum]) -> None:
    assert [str(word) for word in kind] == json.loads((GOLDEN / "words.json").read_text())[kind.__name__]


def test_the_words_of_a_mode_stay() -> None:
    """A new kind of mission brings a word; clients take ``mode`` as a text."""
    assert set(json.loads((GOLDEN / "words.json").read_text())["Mode"]) <= set(MODE_WORDS)
