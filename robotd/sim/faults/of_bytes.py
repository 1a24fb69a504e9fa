"""Faults that change single bytes: noise, a wrong speed, a stuck line."""

import random

from robotd.hardware.link.tap import Direction
from robotd.sim.faults.fault import Fault

_STUCK_AT = (0x00, 0x55, 0xFF)
"""A line held low, whose zeros part our frames; one that alternates; one held high."""
_FLIPPED_ONE_IN = 50


class Garbage(Fault):
    """Every byte arrives as another one, both ways."""

    def changed(self, data: bytes, way: Direction) -> bytes:
        """Return as many bytes of noise."""
        return self._rng.randbytes(len(data))


class HalfBaud(Fault):
    """One side runs at half the speed of the other: each byte is seen as two wrong ones."""

    def changed(self, data: bytes, way: Direction) -> bytes:
        """Return each bit twice, as a receiver sees them that samples twice as fast."""
        # The low half first: a serial line sends the lowest bit first.
        return bytes(half for byte in data for half in (_stretched(byte & 0x0F), _stretched(byte >> 4)))


class StuckByte(Fault):
    """The line says one and the same byte, whatever was sent."""

    def __init__(self, rng: random.Random) -> None:
        """Choose which byte."""
        super().__init__(rng)
        self._byte = bytes((rng.choice(_STUCK_AT),))

    def changed(self, data: bytes, way: Direction) -> bytes:
        """Return it as often as bytes were sent."""
        return self._byte * len(data)


class BitFlips(Fault):
    """One byte in fifty arrives with one bit wrong, both ways."""

    def changed(self, data: bytes, way: Direction) -> bytes:
        """Return the bytes, some of them flipped."""
        return bytes(
            byte ^ (1 << self._rng.randrange(8)) if self._rng.randrange(_FLIPPED_ONE_IN) == 0 else byte for byte in data
        )


def _stretched(nibble: int) -> int:
    """Return the byte in which each of four bits stands twice.

    >>> f"{_stretched(0b0101):08b}"
    '00110011'
    """
    return sum(0b11 << (2 * bit) for bit in range(4) if nibble & 1 << bit)
