"""A board's dictionary says all, and a host notices what it needs and does not get."""

import copy
import json
import zlib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_proto.common import BoardKind
from firmware_proto.dictionary import dictionary_for, messages_for, missing_or_different, parse_dictionary
from firmware_proto.schema import wire_fields

OURS = parse_dictionary(dictionary_for(BoardKind.DRIVE))


def _theirs() -> dict[str, Any]:
    return copy.deepcopy(OURS)


@pytest.mark.parametrize("kind", BoardKind)
def test_holds_every_message_with_every_field(kind: BoardKind) -> None:
    content = parse_dictionary(dictionary_for(kind))
    assert content["device"] == kind.name.lower()
    assert content["protocol"] == [1, 0]
    for message in messages_for(kind):
        described = content["messages"][message.__name__]
        assert described["type"] == message.TYPE
        for field, (name, wire) in zip(described["fields"], wire_fields(message).items(), strict=True):
            assert field == {"name": name, "code": wire.code, "unit": wire.unit, "meaning": wire.meaning}


@pytest.mark.parametrize("kind", BoardKind)
def test_is_the_same_bytes_every_time_and_small_enough(kind: BoardKind) -> None:
    assert dictionary_for(kind) == dictionary_for(kind)
    assert len(dictionary_for(kind)) < 4096


def test_explains_the_enumerations_that_its_fields_use() -> None:
    assert OURS["enums"]["Fault"]["DEADMAN"] == 1
    assert OURS["enums"]["BoardState"]["ARMED"] == 3
    assert "ShotStatus" not in OURS["enums"]


def test_the_same_dictionary_lacks_nothing() -> None:
    assert missing_or_different(_theirs(), OURS) == []


def test_more_messages_and_other_wording_do_not_matter() -> None:
    theirs = _theirs()
    theirs["messages"]["Dance"] = {"type": 0x1F, "fields": []}
    theirs["messages"]["Ping"]["fields"][0]["meaning"] = "Something else."
    theirs["enums"]["Fault"]["OVERHEATED"] = 32
    assert missing_or_different(theirs, OURS) == []


def test_a_missing_message_is_named() -> None:
    theirs = _theirs()
    del theirs["messages"]["OdometryReport"]
    assert missing_or_different(theirs, OURS) == ["OdometryReport is missing"]


def test_a_moved_message_is_named() -> None:
    theirs = _theirs()
    theirs["messages"]["Stop"]["type"] = 0x13
    assert missing_or_different(theirs, OURS) == ["Stop has type 19, not 17"]


@pytest.mark.parametrize("change", [{"code": "i"}, {"unit": "cm/s"}, {"name": "speed"}])
def test_a_changed_field_is_named_with_both_layouts(change: dict[str, str]) -> None:
    theirs = _theirs()
    theirs["messages"]["SetVelocity"]["fields"][0] |= change
    (difference,) = missing_or_different(theirs, OURS)
    assert difference.startswith("SetVelocity has fields (")
    assert difference.endswith("not (speed_mmps:h mm/s, turn_mradps:h mrad/s, ttl_ms:H ms)")


def test_swapped_fields_are_named() -> None:
    theirs = _theirs()
    theirs["messages"]["SetVelocity"]["fields"].reverse()
    assert len(missing_or_different(theirs, OURS)) == 1


def test_a_changed_enumeration_is_named() -> None:
    theirs = _theirs()
    theirs["enums"]["Result"]["BUSY"] = 9
    del theirs["enums"]["Fault"]["KILLED"]
    assert missing_or_different(theirs, OURS) == ["Result.BUSY is 9, not 5", "Fault.KILLED is missing, not 16"]


def test_another_device_is_named() -> None:
    theirs = parse_dictionary(dictionary_for(BoardKind.PANTILT))
    assert "the board is a pantilt, not a drive" in missing_or_different(theirs, OURS)


@given(st.binary(max_size=200))
def test_damaged_dictionaries_are_refused(damage: bytes) -> None:
    with pytest.raises(ValueError, match="dictionary"):
        parse_dictionary(damage)


def test_a_cut_dictionary_is_refused() -> None:
    whole = dictionary_for(BoardKind.DRIVE)
    for size in range(0, len(whole), 50):
        with pytest.raises(ValueError, match="dictionary"):
            parse_dictionary(whole[:size])


@pytest.mark.parametrize(
    "content",
    [
        [],
        {},
        {"device": 1, "messages": {}, "enums": {}},
        {"device": "drive", "messages": {"A": 1}, "enums": {}},
        {"device": "drive", "messages": {"A": {"fields": [1]}}, "enums": {}},
        {"device": "drive", "messages": {}, "enums": {"A": []}},
    ],
)
def test_json_of_another_shape_is_refused(content: object) -> None:
    with pytest.raises(ValueError, match="dictionary"):
        parse_dictionary(zlib.compress(json.dumps(content).encode()))


def test_a_bomb_is_not_unpacked() -> None:
    with pytest.raises(ValueError, match="dictionary"):
        parse_dictionary(zlib.compress(b" " * 50_000_000))
