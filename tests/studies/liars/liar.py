"""A device that lies, as a fault of its cable: the bytes are sound, and what they say cannot be."""

import random

from robotd.core.clock import NS_PER_S, now_ns
from robotd.hardware.link.tap import Direction
from robotd.sim.faults.fault import Fault
from tests.studies.liars.lies import Tongue

_ONCE, _SOME, _ALWAYS = 1, 5, 1_000_000


class Liar(Fault):
    """Changes one message of a kind, a few, or all from a moment on; without any to change it makes one up."""

    def __init__(self, rng: random.Random, tongue: Tongue) -> None:
        super().__init__(rng)
        self._tongue = tongue
        self._rest = b""
        self._left = rng.choice((_ONCE, _ONCE, _SOME, _ALWAYS))
        self._skip = rng.randrange(6)
        self._sized: int | None = None
        self._choosy = rng.random() < 0.7
        self.told: list[str] = []
        """What was said in place of what, for people; the first few."""
        self.told_ns: int | None = None

    def changed(self, data: bytes, way: Direction) -> bytes:
        """Return the messages, some of them untrue."""
        if way is Direction.TO_BOARD:
            return data
        messages, self._rest = self._tongue.split(self._rest + data)
        return b"".join(map(self._said, messages))

    def _said(self, honest: bytes) -> bytes:
        if self._skip:
            self._skip -= 1
            return honest
        if not self._left or (self._sized is not None and self._choosy and len(honest) != self._sized):
            return honest
        lie = self._tongue.lie(honest, self._rng)
        if lie == honest:
            return honest
        self._sized = len(honest)  # messages of a kind have a size: it lies about the same again
        self._left -= 1
        self.told_ns = now_ns() if self.told_ns is None else self.told_ns
        if len(self.told) < 3:
            self.told.append(f"{honest.hex()} -> {lie.hex()}")
        return lie

    @property
    def since_s(self) -> float | None:
        """How long ago it lied first."""
        return None if self.told_ns is None else (now_ns() - self.told_ns) / NS_PER_S
