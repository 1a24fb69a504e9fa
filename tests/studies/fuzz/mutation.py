"""Small changes to bytes, of the kinds that break parsers."""

import random
from collections.abc import Callable, Sequence

_INTERESTING = bytes((0x00, 0x01, 0x0A, 0x0D, 0x1B, 0x20, 0x2A, 0x59, 0x5A, 0x7F, 0x80, 0xAA, 0xFD, 0xFE, 0xFF))
_NUMBERS = (b"0", b"-1", b"nan", b"inf", b"-0.0", b"1e999", b"99999999999999999999", b"0x10")
_RUN_MAX = 32
_CHANGES_MAX = 4

Change = Callable[[random.Random, bytearray], None]


def mutated(rng: random.Random, data: bytes, other: bytes, tokens: Sequence[bytes], size_max: int) -> bytes:
    """Return ``data`` with one to four changes; pieces may come from another input, or be words of the language."""
    changed = bytearray(data)
    for _ in range(rng.randint(1, _CHANGES_MAX)):
        if rng.random() < 0.2:
            word = rng.choice((*tokens, *_NUMBERS))
            at = rng.randint(0, len(changed))
            changed[at : at + rng.choice((0, len(word)))] = word
        elif rng.random() < 0.1 and other:
            start = rng.randrange(len(other))
            changed[rng.randint(0, len(changed)) :] = other[start:]
        else:
            rng.choice(_CHANGES)(rng, changed)
    return bytes(changed[:size_max])


def _flip(rng: random.Random, data: bytearray) -> None:
    if data:
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)


def _set(rng: random.Random, data: bytearray) -> None:
    if data:
        data[rng.randrange(len(data))] = rng.choice(_INTERESTING)


def _insert(rng: random.Random, data: bytearray) -> None:
    at = rng.randint(0, len(data))
    data[at:at] = rng.randbytes(rng.randint(1, 4))


def _delete(rng: random.Random, data: bytearray) -> None:
    at = rng.randint(0, len(data))
    del data[at : at + rng.randint(1, _RUN_MAX)]


def _double(rng: random.Random, data: bytearray) -> None:
    at = rng.randint(0, len(data))
    run = data[at : at + rng.randint(1, _RUN_MAX)]
    data[at:at] = run * rng.choice((1, 1, 2, 16))


def _cut(rng: random.Random, data: bytearray) -> None:
    del data[rng.randint(0, len(data)) :]


_CHANGES: tuple[Change, ...] = (_flip, _flip, _set, _insert, _delete, _double, _cut)
