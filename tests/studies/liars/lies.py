"""Messages with absurd values and right checksums, in every dialect.

A dialect is parted into its messages, and one of them is changed: a field of one of our boards' messages, the numbers
of a line of text, the bytes between head and checksum of a packet.
"""

import binascii
import random
import re
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from firmware_proto.common import BoardKind
from firmware_proto.dictionary import answers_for
from firmware_proto.framing import Deframer, RawFrame, encode_frame
from firmware_proto.schema import Message, wire_fields
from robotd.hardware.wire import dynamixel, rflex
from robotd.hardware.wire.scip import sum_of

Split = Callable[[bytes], tuple[list[bytes], bytes]]
"""Parts bytes into whole messages, and what may be the beginning of another."""
Lie = Callable[[bytes, random.Random], bytes]
"""Returns a message in place of one; checksums are right."""

_NUMBER = re.compile(rb"[0-9A-Fa-f]{4,}|[+-]?\d+(?:\.\d+)?")


@dataclass(frozen=True, slots=True)
class Tongue:
    """How to lie in one dialect."""

    split: Split
    lie: Lie


def absurd(code: str, honest: Any, rng: random.Random) -> Any:
    """Return a value for a field of our own boards, as a format character of :mod:`struct`."""
    if code.endswith("s"):
        return rng.randbytes(len(honest))
    bits = 8 * struct.calcsize(code)
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if code.islower() else (0, (1 << bits) - 1)
    near = [honest + sign * by for by in (1, 1000, 450_000, 3_600_000_000) for sign in (1, -1)]
    somewhere = [1 << rng.randrange(bits), rng.randint(low, high)]
    choices = [low, high, 0, 1, low + 1, high - 1, (high + low) // 2, *near, *somewhere]
    return min(max(rng.choice(choices), low), high)


def _own(kind: BoardKind) -> Tongue:
    layouts = answers_for(kind)

    def split(data: bytes) -> tuple[list[bytes], bytes]:
        *whole, rest = data.split(b"\0")
        return [b"\0" + one + b"\0" for one in whole if one], rest

    def lie(data: bytes, rng: random.Random) -> bytes:
        frames = Deframer().feed(data)
        if not frames or frames[0].type not in layouts:
            return data
        frame = frames[0]
        message = layouts[frame.type].from_payload(frame.payload)
        return encode_frame(RawFrame(frame.type, frame.seq, _changed(message, rng).to_payload()))

    return Tongue(split, lie)


def _changed(message: Message, rng: random.Random) -> Message:
    wires = wire_fields(type(message))
    names = [field.name for field in fields(message)]  # type: ignore[arg-type]  # every message is a dataclass
    chosen = names if rng.random() < 0.1 else [rng.choice(names)]
    what = {name: absurd(wires[name].code, getattr(message, name), rng) for name in chosen}
    changed: Message = replace(message, **what)  # type: ignore[type-var]  # every message is a dataclass
    return changed


def _lines(end: bytes = b"\r\n") -> Split:
    def split(data: bytes) -> tuple[list[bytes], bytes]:
        *whole, rest = data.split(end)
        return [one + end for one in whole], rest

    return split


def _number(found: bytes, rng: random.Random, *, hexadecimal: bool, same_length: bool) -> bytes:
    size = len(found.lstrip(b"+-"))
    if hexadecimal:
        return rng.choice((b"F" * size, b"0" * size, b"7" + b"F" * (size - 1), b"8" + b"0" * (size - 1), b"A" * size))
    digits = rng.choice((b"9" * size, b"0" * size, b"1".zfill(size), str(rng.randrange(10**size)).zfill(size).encode()))
    if not same_length:
        digits = rng.choice((digits, b"9" * 9, b"9" * 30, b"0", b"0.000000001", b"130.00", b"1e9"))
    is_signed = found.startswith((b"+", b"-"))
    return rng.choice((b"+", b"-") if is_signed else (b"", b"" if same_length else b"-")) + digits


def _text(*, hexadecimal: bool = False, same_length: bool = False) -> Lie:
    def lie(line: bytes, rng: random.Random) -> bytes:
        places = [found for found in _NUMBER.finditer(line) if hexadecimal or not found[0].isalpha()]
        if hexadecimal:
            places = [found for found in places if len(found[0]) >= 2 and line[: found.start()].strip()]
        if not places:
            return line
        found = rng.choice(places)
        told = _number(found[0], rng, hexadecimal=hexadecimal, same_length=same_length)
        return line[: found.start()] + told + line[found.end() :]

    return lie


def _rwi(line: bytes, rng: random.Random) -> bytes:
    event = rng.choice((b"%BS 0000", b"%BS FFFFFFFF", b"%WDT motors stopped", b"%BLO", b"%TERR", b"%RC 1234", b"%BHI"))
    return event + b"\r\n" + line if rng.random() < 0.2 else _text(hexadecimal=True)(line, rng)


def _ptu(line: bytes, rng: random.Random) -> bytes:
    told = rng.choice((b"!P", b"!T", b"! Illegal", b"* PAN-TILT", b"PAN-TILT v9\r\n", b"* 1e300"))
    return told + line if rng.random() < 0.2 else _text()(line, rng)


def _dimetix(line: bytes, rng: random.Random) -> bytes:
    if rng.random() < 0.2:
        return line[:2] + b"@E" + rng.choice((b"000", b"999", b"203", b"255")) + b"\r\n"
    return _text(same_length=True)(line, rng)


def _scip_split(data: bytes) -> tuple[list[bytes], bytes]:
    *whole, rest = data.split(b"\n\n")
    return [one + b"\n\n" for one in whole], rest


def _scip(block: bytes, rng: random.Random) -> bytes:
    lines = block.decode("ascii").strip("\n").split("\n")
    for number in rng.sample(range(1, len(lines)), min(len(lines) - 1, rng.choice((1, 2, 99)))):
        text = lines[number][:-1].rstrip(";")
        name, colon, value = text.partition(":")
        if colon:
            text = f"{name}:{_number(value.encode(), rng, hexadecimal=False, same_length=False).decode()}"
        elif number > 1:
            text = "".join(rng.choice(("0", "o", "1", chr(0x30 + rng.randrange(64)))) for _ in text)
        else:
            text = rng.choice(("00", "99", "01", "10", "0E"))
        lines[number] = text + sum_of(text)
    return ("\n".join(lines) + "\n\n").encode("ascii")


def _tfmini_split(data: bytes) -> tuple[list[bytes], bytes]:
    whole = []
    while len(data) >= 2:
        size = 9 if data[0] == 0x59 else max(data[1], 1)
        if len(data) < size:
            break
        whole.append(data[:size])
        data = data[size:]
    return whole, data


def _tfmini(frame: bytes, rng: random.Random) -> bytes:
    body = bytearray(frame[:-1])
    at = rng.randrange(2, len(body))
    numbers = (0, 0xFFFF, 0xFFFE, 0xFFFD, 0xFFFC, 1200, 22_873, rng.randrange(0x10000))
    if body[0] == 0x59:
        at = rng.choice((2, 2, 2, 4))
        body[at : at + 2] = rng.choice(numbers).to_bytes(2, "little")
    else:
        body[at] = rng.randrange(256)
    return bytes(body) + bytes((sum(body) & 0xFF,))


def _lwnx_split(data: bytes) -> tuple[list[bytes], bytes]:
    whole = []
    while len(data) >= 3:
        size = 5 + (int.from_bytes(data[1:3], "little") >> 6)
        if len(data) < size:
            break
        whole.append(data[:size])
        data = data[size:]
    return whole, data


def _lwnx(packet: bytes, rng: random.Random) -> bytes:
    body = bytearray(packet[:-2])
    if len(body) > 5:
        value = rng.choice((-32_768, 32_767, 0, -1, 10_001, 13_000))
        body[4:6] = value.to_bytes(2, "little", signed=True)
    else:
        body[-1] = rng.randrange(256)
    return bytes(body) + binascii.crc_hqx(bytes(body), 0).to_bytes(2, "little")


def _dynamixel_split(data: bytes) -> tuple[list[bytes], bytes]:
    whole = []
    while len(data) >= 7:
        size = 7 + int.from_bytes(data[5:7], "little")
        if len(data) < size:
            break
        whole.append(data[:size])
        data = data[size:]
    return whole, data


def _dynamixel(packet: bytes, rng: random.Random) -> bytes:
    servo, error, parameters = packet[4], packet[8], packet[9:-2]
    if rng.random() < 0.3:
        error = rng.choice((0x80, 0x81, 7, 1, 0x7F, 0xFF))
    else:
        filling = rng.choice((b"\xff", b"\x00", b"\x80", b"\x7f"))
        parameters = rng.choice((filling * len(parameters), rng.randbytes(len(parameters)), filling * 4, b""))
    return dynamixel.packet(servo, dynamixel.STATUS, bytes((error,)) + parameters)


def _rflex_split(data: bytes) -> tuple[list[bytes], bytes]:
    whole = []
    while len(data) >= 6:
        size = data[5] + rflex.OVERHEAD
        if len(data) < size:
            break
        whole.append(data[:size])
        data = data[size:]
    return whole, data


def _rflex(frame: bytes, rng: random.Random) -> bytes:
    port, sender, opcode, content = frame[2], frame[3], frame[4], bytearray(frame[6:-3])
    at = rng.choice([place for place in (4, 8, 9, 13, 17) if place < len(content)] or [0])
    filling = rng.choice((b"\xff", b"\x00", b"\x80", b"\x7f"))
    size = 1 if at == 8 and len(content) > 9 else 4
    content[at : at + size] = (rng.choice((filling, filling + b"\0\0\0", filling * 4, rng.randbytes(4))) * 4)[:size]
    return rflex.frame(port, opcode, bytes(content), sender=sender)


TONGUES: Mapping[tuple[str, str], Tongue] = {
    **{(kind.name.lower(), "board"): _own(kind) for kind in BoardKind},
    ("drive", "rwi-ascii"): Tongue(_lines(), _rwi),
    ("drive", "rflex"): Tongue(_rflex_split, _rflex),
    ("pantilt", "ptu"): Tongue(_lines(), _ptu),
    ("pantilt", "dynamixel"): Tongue(_dynamixel_split, _dynamixel),
    ("rangefinder", "dimetix"): Tongue(_lines(), _dimetix),
    ("rangefinder", "disto"): Tongue(_lines(), _text(same_length=True)),
    ("rangefinder", "lw20"): Tongue(_lines(), _text()),
    ("rangefinder", "lwnx"): Tongue(_lwnx_split, _lwnx),
    ("rangefinder", "tfmini-s"): Tongue(_tfmini_split, _tfmini),
    ("rangefinder", "scip"): Tongue(_scip_split, _scip),
}
"""By device and dialect."""
