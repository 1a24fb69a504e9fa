"""The parsers of what comes over a serial line."""

import json
from collections.abc import Callable
from functools import cache, partial
from importlib import resources

from firmware_proto.common import BoardKind
from firmware_proto.dictionary import dictionary_for, parse_dictionary
from firmware_proto.framing import Deframer
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.wire import disto
from robotd.hardware.wire.board import BoardWire
from robotd.hardware.wire.dimetix import DimetixWire
from robotd.hardware.wire.dynamixel import DynamixelWire
from robotd.hardware.wire.lw20 import Lw20Wire
from robotd.hardware.wire.lwnx import LwnxWire
from robotd.hardware.wire.ptu import PtuWire
from robotd.hardware.wire.rflex import RflexWire
from robotd.hardware.wire.rwi_ascii import RwiWire
from robotd.hardware.wire.scip import ScipWire, sum_of
from robotd.hardware.wire.tfmini import TfminiWire
from tests.studies.fuzz.target import Target, of_stream

_WIRES = "robotd/hardware/wire"
_RWI_ITEMS = 0xE0EF0


@cache
def _frames(*names: str) -> list[bytes]:
    vectors = resources.files("firmware_proto").joinpath("vectors")
    texts = [vectors.joinpath(f"{name}.json").read_text(encoding="utf-8") for name in ("common", *names)]
    return [bytes.fromhex(vector["wire"]) for text in texts for vector in json.loads(text)["vectors"]]


def _hex(*lines: str) -> Callable[[], list[bytes]]:
    return lambda: [bytes.fromhex(line) for line in lines]


def _ended(*lines: bytes) -> Callable[[], list[bytes]]:
    return lambda: [line + b"\r\n" for line in lines]


def _board(kind: BoardKind) -> Target:
    name = kind.name.lower()
    return of_stream(f"board-{name}", partial(BoardWire, kind), partial(_frames, name), f"{_WIRES}/board.py")


STREAMS = (
    of_stream("framing", Deframer, partial(_frames, "drive", "pantilt", "rangefinder"), "firmware_proto/framing.py"),
    *map(_board, BoardKind),
    of_stream(
        "rwi-ascii",
        partial(RwiWire, _RWI_ITEMS),
        _ended(
            b"*BV 1e0",
            b"%BS FFFB",
            b"%WDT motors stopped",
            b"%PSR\r\nBPX 8010\r\nBPY 7FF0\r\nTPH 0100\r\nBRH 0120\r\nTVE 1FFE\r\nTPW 0040\r\nTSF 4000\r\n"
            b"RVE 0000\r\nRPW 0000\r\nRSF 0000",
        ),
        f"{_WIRES}/rwi_ascii.py",
        tokens=(b"%PSR\r", b"%TERR\r", b"BPX 8000\r", b"TW ", b"RSF 0000\r", b"%"),
    ),
    of_stream(
        "rflex",
        RflexWire,
        _hex(
            "1B 02 02 07 21 19 00 00 00 00 00 01 E2 40 00 00 03 16 DC 00 00 76 A1 00 01 8B 6E 00 00 75 30 21 1B 03",
            "1B 02 01 09 01 09 00 00 03 E8 00 00 09 7E 01 9D 1B 03",
            "1B 02 05 0A 01 07 00 00 03 E8 42 00 03 A3 1B 03",
        ),
        f"{_WIRES}/rflex.py",
        tokens=(b"\x1b\x02", b"\x1b\x03"),
    ),
    of_stream(
        "ptu",
        PtuWire,
        _ended(b"FT *", b"* 185.142857", b"PP * 22", b"! Illegal Command Entered", b"!T!T!P!P*", b"PAN-TILT v2.12"),
        f"{_WIRES}/ptu.py",
        tokens=(b"!P", b"!T", b"* ", b"*\r", b"! "),
    ),
    of_stream(
        "dynamixel",
        DynamixelWire,
        _hex(
            "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D",
            "FF FF FD 00 01 03 00 01 19 4E",
            "FF FF FD 00 FE 11 00 83 74 00 04 00 01 00 08 00 00 02 00 04 00 00 98 4C",
        ),
        f"{_WIRES}/dynamixel.py",
        tokens=(b"\xff\xff\xfd", b"\xff\xff\xfd\x00", b"\xff\xff\xfd\xfd"),
    ),
    of_stream(
        "dimetix",
        DimetixWire,
        _ended(b"g0g+00012345", b"g0@E255", b"g0?", b"g0t+00000253"),
        f"{_WIRES}/dimetix.py",
        tokens=(b"g0g+", b"@E", b"\r\n"),
    ),
    of_stream(
        "disto",
        partial(DimetixWire, disto.parsed),
        _ended(b"31..06+00012345 51....+00000000", b"?", b"@E255", b"40..06+00000253"),
        f"{_WIRES}/disto.py",
        tokens=(b"31..06+", b"31..0", b"@E", b"\r\n", b"?\r"),
    ),
    of_stream(
        "tfmini",
        TfminiWire,
        _hex("59 59 7B 00 E8 03 C8 08 E8", "5A 07 01 08 00 02 6C", "5A 05 11 00 6F"),
        f"{_WIRES}/tfmini.py",
        tokens=(b"\x59\x59", b"\x5a\x05"),
    ),
    of_stream(
        "lw20",
        Lw20Wire,
        _ended(b"ldf,0:23.67", b"lf:0", b"p:LW20,1.0,1"),
        f"{_WIRES}/lw20.py",
        tokens=(b"ldf,", b":", b"\r\n"),
    ),
    of_stream(
        "lwnx",
        LwnxWire,
        _hex("AA 40 00 00 70 9F", "AA 40 01 2C D2 04 57 00 C5 02", "AA 81 00 32 00 B1 A4"),
        f"{_WIRES}/lwnx.py",
        tokens=(b"\xaa\x40\x00", b"\xaa\x40\x01"),
    ),
    of_stream(
        "scip",
        ScipWire,
        lambda: [
            b"PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\nDMAX:5600;_\nARES:1024;\\\nAMIN:44;7\n\n",
            b"MD0000000200000\n99b\n0000`\n1Dh1Dh1Dh" + sum_of("1Dh1Dh1Dh").encode() + b"\n\n",
        ],
        f"{_WIRES}/scip.py",
        tokens=(b"\n\n", b"00P\n", b"99b\n", b"PP\n"),
    ),
    Target(
        "dictionary",
        parse_dictionary,
        lambda: [dictionary_for(kind) for kind in BoardKind],
        ("firmware_proto/dictionary.py",),
        typed=(ValueError,),
        size_max=4096,
    ),
    Target(
        "line-format",
        lambda data: LineFormat.parse(data.decode("utf-8", errors="replace")),
        lambda: [b"19200 7E1", b"115200 8N1"],
        ("robotd/hardware/transport/line_format.py",),
        typed=(ValueError,),
        size_max=64,
    ),
)
