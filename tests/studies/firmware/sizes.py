"""How much flash and RAM the C takes on a microcontroller: a table.

``python -m tests.studies.firmware.sizes [COMPILER]``

Each row is a program linked without what it does not use: the codec alone with every message packed and unpacked,
then a whole board of each device, whose hardware does nothing.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

from firmware_proto.c_messages import c_name
from firmware_proto.common import BoardKind
from firmware_proto.dictionary import messages_for
from firmware_proto.schema import wire_fields
from tests.studies.firmware.compiling import C

FLAGS = ("-mcpu=cortex-m0", "-mthumb", "-Os", "-std=c99", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections")
FREESTANDING = ("-nostartfiles", "-Wl,-e,start", "-Wl,--no-warn-rwx-segments")
_CODEC = """
#include "frame.h"
void start(void);
static struct bp_receiver receiver;
static uint8_t wire[BP_WIRE_SIZE(BP_PAYLOAD_MAX)];
volatile uint8_t uart;
void start(void)
{{
    struct bp_frame frame;
    bp_receiver_reset(&receiver);
    for (;;) {{
        if (!bp_receive(&receiver, uart, &frame))
            continue;
{uses}
        uart = wire[bp_encode(frame.type, frame.seq, frame.payload, frame.size, wire) - 1];
    }}
}}
"""
_BOARD = """
#include "{device}.h"
void start(void);
static struct {device} device;
static const volatile struct {device}_hal hal;
static const volatile struct board_line line;
volatile uint8_t uart;
volatile uint64_t now_us;
void start(void)
{{
    {device}_power_up(&device, (const struct {device}_hal *)&hal, (const struct board_line *)&line, 1);
    for (;;) {{
        const uint8_t heard = uart;
        board_receive(&device.board, &heard, 1, now_us);
    }}
}}
"""


def main(compiler: str) -> None:
    """Print the table."""
    version = subprocess.run([compiler, "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0]
    print(f"{version}, {' '.join(FLAGS[:3])}\n")
    print("| program | flash [bytes] | of it the dictionary | RAM [bytes], without the stack |\n|---|---|---|---|")
    print(_row("codec, every message", _linked(compiler, _CODEC.format(uses=_uses())), 0))
    devices = (C / "devices.c").read_text(encoding="utf-8")
    for kind in BoardKind:
        name = kind.name.lower()
        found = re.search(rf"{name}_dictionary, 0x\w+, (\d+),", devices)
        assert found is not None
        print(_row(f"{name} board", _linked(compiler, _BOARD.format(device=name)), int(found[1])))


def _row(name: str, sizes: tuple[int, int], dictionary: int) -> str:
    return f"| {name} | {sizes[0]} | {dictionary or '-'} | {sizes[1]} |"


def _uses() -> str:
    messages = {message.__name__: message for kind in BoardKind for message in messages_for(kind)}
    names = [c_name(name) for name, message in messages.items() if wire_fields(message)]
    use = "        {{ struct bp_{0} m; if (bp_unpack_{0}(frame.payload, frame.size, &m)) bp_pack_{0}(&m, wire); }}"
    return "\n".join(use.format(name) for name in names)


def _linked(compiler: str, source: str) -> tuple[int, int]:
    """Return flash and RAM of a program."""
    with tempfile.TemporaryDirectory() as directory:
        main_c, program = Path(directory) / "main.c", Path(directory) / "program"
        main_c.write_text(source)
        words = [compiler, *FLAGS, *FREESTANDING, f"-I{C}", str(main_c), *map(str, C.glob("*.c")), "-o", str(program)]
        subprocess.run(words, check=True)
        sized = subprocess.run(
            [re.sub(r"gcc$", "size", compiler), str(program)], check=True, capture_output=True, text=True
        )
    text, data, bss = map(int, sized.stdout.splitlines()[1].split()[:3])
    return text + data, data + bss


if __name__ == "__main__":
    main(*(sys.argv[1:] or ["arm-none-eabi-gcc"]))
