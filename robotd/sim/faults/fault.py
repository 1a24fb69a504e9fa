"""What can go wrong on a cable, as something that lasts for a while and then is over.

A fault sees what passes, in either direction, and the cable itself. It draws all its luck from one seed.
"""

import asyncio
import contextlib
import random
from typing import Protocol

from robotd.core.errors import TransportError
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.transport import Transport


class CableEnd(Protocol):
    """The part of a cable that a fault may lay hands on."""

    def unplug(self) -> None:
        """Pull the plug at the host's side; anyone who opens the port finds none."""

    def plug(self) -> None:
        """Put it back, under another name of the system's; a name of ours leads there again."""

    def exchange(self, *, stranger: bool) -> None:
        """Pull the plug and plug another device in, or the right one again."""

    def reboot(self) -> None:
        """Take the board's power away, and give it back."""


class Fault:
    """One fault; this one harms nothing, and is what a cable has while nothing is wrong with it."""

    refuses_writes = False
    """Whether a write of the host fails, and takes the line with it."""

    def __init__(self, rng: random.Random) -> None:
        """Prepare; it begins with :meth:`begin`."""
        self._rng = rng
        self._over = asyncio.Event()

    def begin(self, line: CableEnd) -> None:
        """Do to the cable what begins the fault."""

    def end(self, line: CableEnd) -> None:
        """Undo it; a subclass that overrides this calls it."""
        self._over.set()

    def changed(self, data: bytes, way: Direction) -> bytes:
        """Return what arrives of bytes that were sent."""
        return data

    async def pass_on(self, data: bytes, way: Direction, sink: Transport) -> None:
        """Deliver what arrives, when it arrives; TransportError breaks the line."""
        deliver(self.changed(data, way), sink)

    async def disturb(self, host: Transport, board: Transport) -> None:
        """Send what nobody said, until it is over."""
        await self._over.wait()

    async def _pause(self, seconds: float) -> None:
        """Wait, but no longer than the fault lasts."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self._over.wait()

    @property
    def _is_over(self) -> bool:
        return self._over.is_set()


def deliver(data: bytes, sink: Transport) -> None:
    """Hand bytes over; those for which there is no room are lost, and that a line is gone shows in reading it."""
    if data:
        with contextlib.suppress(TransportError):
            sink.write(data)
