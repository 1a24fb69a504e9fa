"""The C that is written from the declarations says what they say; tests/studies/firmware compiles it and runs it."""

import json
import re
import zlib

import pytest

from firmware_proto import c_devices, generate
from firmware_proto.common import BoardKind, BoardState
from firmware_proto.dictionary import dictionary_for, messages_for, requests_for
from firmware_proto.rules import RULES
from firmware_proto.schema import payload_size

HEADER = (generate.HERE / "c" / "messages.h").read_text(encoding="utf-8")
DEVICES = (generate.HERE / "c" / "devices.c").read_text(encoding="utf-8")


def test_every_message_has_its_type_and_size_in_the_header() -> None:
    for kind in BoardKind:
        for message in messages_for(kind):
            name = "BP_" + re.sub(r"(?<!^)(?=[A-Z])", "_", message.__name__).upper()
            assert (
                f"#define {name}_TYPE 0x{message.TYPE:02X}u\n#define {name}_SIZE {payload_size(message)}u\n" in HEADER
            )


@pytest.mark.parametrize("kind", BoardKind)
def test_the_dictionary_in_flash_is_the_one_of_the_declarations(kind: BoardKind) -> None:
    blob = c_devices.dictionary_in(DEVICES, kind)
    assert blob is not None
    assert json.loads(zlib.decompress(blob)) == json.loads(zlib.decompress(dictionary_for(kind)))
    assert f"0x{zlib.crc32(blob):08X}u, {len(blob)}, {len(requests_for(kind))}\n" in DEVICES


@pytest.mark.parametrize("kind", BoardKind)
def test_each_request_has_its_rule_in_flash(kind: BoardKind) -> None:
    table = re.search(rf"{kind.name.lower()}_rules\[\] = \{{(.*?)\}};", DEVICES, re.DOTALL)
    assert table is not None
    rows = re.findall(r"\{BP_(\w+)_TYPE, BP_\1_SIZE, 0x(..), (\w+)\}", table[1])
    assert len(rows) == len(requests_for(kind))
    for request, (name, states, remember) in zip(requests_for(kind).values(), rows, strict=True):
        assert name.replace("_", "").lower() == request.__name__.lower()
        assert {state for state in BoardState if int(states, 16) >> state & 1} == RULES[request].states
        assert (remember != "BP_NOT_REMEMBERED") == RULES[request].deduplicated


def test_another_compressor_does_not_make_the_dictionary_stale() -> None:
    """What is compressed differs from library to library; what it says does not."""
    blob = dictionary_for(BoardKind.DRIVE)
    other = zlib.compress(zlib.decompress(blob), 1)
    assert other != blob

    def written(data: bytes) -> str:
        listed = " ".join(f"0x{byte:02X}," for byte in data)
        return f"static const uint8_t drive_dictionary[] = {{\n{listed}\n}};"

    assert c_devices.dictionary_in(c_devices.source(written(other)), BoardKind.DRIVE) == other
    assert c_devices.dictionary_in(c_devices.source(written(other[:-3])), BoardKind.DRIVE) == blob
    assert c_devices.dictionary_in(c_devices.source(written(b"noise")), BoardKind.DRIVE) == blob
