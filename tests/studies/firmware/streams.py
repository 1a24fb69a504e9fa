"""Random streams of bytes as a serial line makes them: sound frames, damaged, cut, glued, and noise."""

import random

from firmware_proto.framing import PAYLOAD_MAX, RawFrame, cobs_encode, crc16, encode_frame
from firmware_proto.schema import payload_size
from tests.studies.firmware.codec import LAYOUTS


def random_frame(dice: random.Random) -> bytes:
    """Return the wire bytes of a frame, mostly of a message with the right size, full of zeros and ones or not."""
    code = dice.choice(list(LAYOUTS)) if dice.random() < 0.9 else dice.randrange(256)
    layout = LAYOUTS.get(code)
    size = payload_size(layout) if layout is not None and dice.random() < 0.9 else dice.randrange(PAYLOAD_MAX + 1)
    few = dice.choice([bytes(range(256)), b"\0\1\xff\x80", b"\0"])
    frame = RawFrame(code, dice.randrange(1 << 16), bytes(dice.choices(few, k=size)))
    return encode_frame(frame) if dice.random() < 0.97 else flagged(frame, dice.randrange(1, 256))


def flagged(frame: RawFrame, flags: int) -> bytes:
    """Return a frame of a later version of the protocol."""
    body = bytes([frame.type, flags, *frame.seq.to_bytes(2, "little"), *frame.payload])
    return b"\0" + cobs_encode(body + crc16(body).to_bytes(2, "big")) + b"\0"


def damaged(dice: random.Random, wire: bytes) -> bytes:
    """Return a frame as a bad line would deliver it."""
    at = dice.randrange(len(wire))
    match dice.randrange(7):
        case 0:
            return wire[:at] + bytes([wire[at] ^ 1 << dice.randrange(8)]) + wire[at + 1 :]
        case 1:
            return wire[:at]
        case 2:
            return wire[at:]
        case 3:
            return wire[:at] + wire[at + 1 :]
        case 4:
            return wire[:at] + bytes([dice.randrange(256)]) + wire[at:]
        case 5:
            return wire.strip(b"\0")  # glued to its neighbours
        case _:
            return noise(dice)


def noise(dice: random.Random) -> bytes:
    """Return bytes that are no frame: random ones, or near the longest packet and the longest COBS run."""
    match dice.randrange(3):
        case 0:
            return dice.randbytes(dice.randrange(600))
        case 1:
            return b"\0" + bytes([dice.choice([1, 0xFE, 0xFF])]) * dice.randrange(250, 260) + b"\0"
        case _:
            return b"\0\xff" + b"\x07" * dice.randrange(250, 257) + b"\0"


def random_stream(seed: int, frames: int) -> bytes:
    """Return a stream of this many frames, a third of them damaged."""
    dice = random.Random(seed)
    wires = (random_frame(dice) for _ in range(frames))
    return b"".join(damaged(dice, wire) if dice.random() < 1 / 3 else wire for wire in wires)
