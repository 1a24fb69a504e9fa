"""A C program that tells what a receiver finds in a stream, and what Python tells of the same stream.

One line for each frame: ``type seq payload``, then the message with its fields, or why there is none. Below a message,
after ``>``, the bytes that encoding it gives. The last line has what was counted: CRC, COBS and length errors.
"""

from collections.abc import Iterator
from pathlib import Path

from firmware_proto.c_messages import c_name, constant
from firmware_proto.common import BoardKind
from firmware_proto.dictionary import answers_for, requests_for
from firmware_proto.framing import Deframer, RawFrame, encode_frame
from firmware_proto.schema import Message, Wire, payload_size, wire_fields
from tests.studies.firmware.compiling import CODEC, C, build

LAYOUTS = {
    code: layout
    for kind in BoardKind
    for layouts in (requests_for(kind), answers_for(kind))
    for code, layout in layouts.items()
}
_MAIN = """
#include <inttypes.h>
#include <stdio.h>

#include "checksum.h"
#include "frame.h"

static uint8_t packed[BP_PAYLOAD_MAX];

static void print_hex(const uint8_t *data, size_t size)
{{
    for (size_t i = 0; i < size; i++)
        printf("%02x", data[i]);
}}

static void print_wire(const struct bp_frame *frame)
{{
    uint8_t wire[BP_WIRE_SIZE(BP_PAYLOAD_MAX)];
    printf("\\n> ");
    print_hex(wire, bp_encode(frame->type, frame->seq, packed, frame->size, wire));
}}

{functions}
static void print_message(const struct bp_frame *frame)
{{
    switch (frame->type) {{
{cases}
    default:
        printf(" UNKNOWN_TYPE");
    }}
}}

int main(void)
{{
    static struct bp_receiver receiver;
    struct bp_frame frame;
    bp_receiver_reset(&receiver);
    for (int byte = getchar(); byte != EOF; byte = getchar()) {{
        if (!bp_receive(&receiver, (uint8_t)byte, &frame))
            continue;
        printf("%u %u ", (unsigned)frame.type, (unsigned)frame.seq);
        print_hex(frame.payload, frame.size);
        print_message(&frame);
        putchar('\\n');
    }}
    printf("%u %u %u\\n", receiver.crc_errors, receiver.cobs_errors, receiver.length_errors);
    return 0;
}}
"""


def build_codec(directory: Path) -> Path:
    """Compile the program."""
    source = directory / "codec.c"
    layouts = {layout.__name__: layout for layout in LAYOUTS.values()}
    cases = "\n".join(
        f"    case 0x{code:02X}:\n        print_{c_name(layout.__name__)}(frame);\n        break;"
        for code, layout in LAYOUTS.items()
    )
    source.write_text(_MAIN.format(functions="\n".join(map(_printer, layouts.values())), cases=cases))
    return build(directory / "codec", [source, *(C / name for name in CODEC)])


def _printer(message: type[Message]) -> str:
    name, fields = c_name(message.__name__), wire_fields(message)
    body = "".join(f"    {_printed(field, wire)}\n" for field, wire in fields.items())
    unpack = f"!bp_unpack_{name}(frame->payload, frame->size, &message)"
    return (
        f"static void print_{name}(const struct bp_frame *frame)\n{{\n"
        + (f"    struct bp_{name} message;\n" if fields else "")
        + f"    if ({unpack if fields else f'frame->size != {constant(message.__name__)}_SIZE'}) {{\n"
        + '        printf(" BAD_LENGTH");\n        return;\n    }\n'
        + f'    printf(" {message.__name__}");\n{body}'
        + (f"    bp_pack_{name}(&message, packed);\n" if fields else "")
        + "    print_wire(frame);\n}\n"
    )


def _printed(name: str, wire: Wire) -> str:
    if wire.code.endswith("s"):
        return f'printf(" {name}="); print_hex(message.{name}, {wire.code[:-1]});'
    if wire.code.islower():
        return f'printf(" {name}=%" PRId32, (int32_t)message.{name});'
    return f'printf(" {name}=%" PRIu64, (uint64_t)message.{name});'


def told_by_python(stream: bytes) -> str:
    """Return what the C program should print."""
    deframer = Deframer()
    lines = [" ".join(_line(frame)).replace(" \n", "\n") for frame in deframer.feed(stream)]
    counted = f"{deframer.crc_errors % 65536} {deframer.cobs_errors % 65536} {deframer.length_errors % 65536}"
    return "\n".join([*lines, counted, ""])


def _line(frame: RawFrame) -> Iterator[str]:
    yield f"{frame.type} {frame.seq} {frame.payload.hex()}"
    layout = LAYOUTS.get(frame.type)
    if layout is None:
        yield "UNKNOWN_TYPE"
    elif payload_size(layout) != len(frame.payload):
        yield "BAD_LENGTH"
    else:
        message = layout.from_payload(frame.payload)
        yield layout.__name__
        for name in wire_fields(layout):
            value = getattr(message, name)
            yield f"{name}={value.hex() if isinstance(value, bytes) else value}"
        yield "\n> " + encode_frame(RawFrame(frame.type, frame.seq, message.to_payload())).hex()
