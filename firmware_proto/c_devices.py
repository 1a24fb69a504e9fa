"""The C of what each board knows of itself: ``devices.h`` and ``devices.c``: rules and dictionary, for its flash."""

import re
import zlib

from firmware_proto.c_messages import NOTICE, c_name, constant
from firmware_proto.common import Ack, BoardKind, BoardState
from firmware_proto.dictionary import dictionary_for, messages_for, requests_for
from firmware_proto.rules import RULES
from firmware_proto.schema import REPLY, payload_size

_BLOB = r"static const uint8_t {name}_dictionary\[\] = \{{(.*?)\}};"
_BYTES_PER_LINE = 20


def header() -> str:
    """Return ``devices.h``."""
    kinds = "".join(f"extern const struct bp_device bp_{kind.name.lower()};\n" for kind in BoardKind)
    return f"""{NOTICE}#ifndef BP_DEVICES_H
#define BP_DEVICES_H

#include "messages.h"

#define BP_NOT_REMEMBERED 0xFFu
#define BP_REMEMBERED_MAX {_remembered_max()}u /* how many deduplicated requests a device has at most */
#define BP_REMEMBERED_SIZE {_remembered_size()}u /* payload of their longest answer [bytes] */

/* How a board treats one request. */
struct bp_rule {{
    uint8_t type;
    uint8_t size;     /* of its payload [bytes], exactly */
    uint8_t states;   /* bit i: allowed in bp_board_state i; where FAULT lies over a state, both must allow it */
    uint8_t remember; /* place of its last answer in a board's memory, or BP_NOT_REMEMBERED */
}};

/* What a board knows of itself. */
struct bp_device {{
    const struct bp_rule *rules;
    const uint8_t *dictionary; /* compressed */
    uint32_t dictionary_crc32;
    uint16_t dictionary_size; /* [bytes] */
    uint8_t rule_count;
}};

{kinds}
#endif
"""


def source(before: str) -> str:
    """Return ``devices.c``; a dictionary that says the same in ``before`` keeps its bytes.

    Compressors differ from machine to machine, and all of them may be right.
    """
    parts = [_device(kind, before) for kind in BoardKind]
    return f'{NOTICE}#include "devices.h"\n\n' + "\n".join(parts)


def dictionary_in(text: str, kind: BoardKind) -> bytes | None:
    """Return the compressed dictionary of a device that stands in ``devices.c``; None if there is none."""
    found = re.search(_BLOB.format(name=kind.name.lower()), text, re.DOTALL)
    return None if found is None else bytes(int(one, 16) for one in re.findall(r"0x(..)", found[1]))


def _device(kind: BoardKind, before: str) -> str:
    name, blob = kind.name.lower(), _dictionary(kind, before)
    lines = [blob[start : start + _BYTES_PER_LINE] for start in range(0, len(blob), _BYTES_PER_LINE)]
    data = "".join("    " + " ".join(f"0x{byte:02X}," for byte in line) + "\n" for line in lines)
    return (
        f"static const struct bp_rule {name}_rules[] = {{\n{_rules(kind)}}};\n\n"
        f"static const uint8_t {name}_dictionary[] = {{\n{data}}};\n\n"
        f"const struct bp_device bp_{name} = {{\n"
        f"    {name}_rules, {name}_dictionary, 0x{zlib.crc32(blob):08X}u, {len(blob)}, {len(requests_for(kind))}\n}};\n"
    )


def _dictionary(kind: BoardKind, before: str) -> bytes:
    fresh, old = dictionary_for(kind), dictionary_in(before, kind)
    try:
        is_same = old is not None and zlib.decompress(old) == zlib.decompress(fresh)
    except zlib.error:
        is_same = False
    # What is checked in stays as it is where it says the same: else each machine would find the file stale.
    return old if old is not None and is_same else fresh


def _rules(kind: BoardKind) -> str:
    remembered = [request for request in requests_for(kind).values() if RULES[request].deduplicated]
    lines = []
    for request in requests_for(kind).values():
        states = sum(1 << state for state in BoardState if state in RULES[request].states)
        place = str(remembered.index(request)) if request in remembered else "BP_NOT_REMEMBERED"
        name = constant(request.__name__)
        lines.append(f"    {{{name}_TYPE, {name}_SIZE, 0x{states:02X}, {place}}}, /* {c_name(request.__name__)} */\n")
    return "".join(lines)


def _remembered_max() -> int:
    return max(sum(RULES[request].deduplicated for request in requests_for(kind).values()) for kind in BoardKind)


def _remembered_size() -> int:
    deduplicated = {request.TYPE | REPLY for request, rule in RULES.items() if rule.deduplicated}
    messages = [message for kind in BoardKind for message in messages_for(kind)]
    return max(payload_size(message) for message in messages if message is Ack or message.TYPE in deduplicated)
