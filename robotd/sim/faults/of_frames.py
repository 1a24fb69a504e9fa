"""Faults that leave bytes alone but not frames: lost, said twice, torn apart."""

from collections.abc import Iterator

from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.transport import Transport
from robotd.sim.faults.fault import Fault, deliver

_HIT_SHARE = 0.3
_TORN_S = 0.015
"""Pause within a torn frame."""


class Dropped(Fault):
    """Three frames in ten are lost, both ways."""

    def changed(self, data: bytes, way: Direction) -> bytes:
        """Return the frames that were not."""
        return b"".join(frame for frame in frames_of(data) if self._rng.random() >= _HIT_SHARE)


class Doubled(Fault):
    """Three frames in ten arrive twice, both ways."""

    def changed(self, data: bytes, way: Direction) -> bytes:
        """Return all frames, and some of them again."""
        return b"".join(frame * (1 + (self._rng.random() < _HIT_SHARE)) for frame in frames_of(data))


class Split(Fault):
    """Every frame arrives in two pieces, with a pause between them, both ways."""

    async def pass_on(self, data: bytes, way: Direction, sink: Transport) -> None:
        """Deliver frame by frame, each in two pieces."""
        for frame in frames_of(data):
            at = self._rng.randrange(len(frame))
            if at:
                deliver(frame[:at], sink)
                await self._pause(_TORN_S)
            deliver(frame[at:], sink)


def frames_of(data: bytes) -> Iterator[bytes]:
    r"""Part bytes after each zero, which ends our boards' frames; what a vendor device says at once counts as one.

    >>> list(frames_of(b"ab\0c\0"))
    [b'ab\x00', b'c\x00']
    """
    while data:
        frame, zero, data = data.partition(b"\0")
        yield frame + zero
