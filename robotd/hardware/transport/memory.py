"""Two ends of a line that is only memory: for tests, replay and emulators in the same process."""

import asyncio

from robotd.core.errors import TransportError
from robotd.hardware.transport.outbox import Outbox

_WIRE_BYTES = 4096
"""How much is under way without being read, like the buffer of a kernel."""


class MemoryEnd:
    """One end. Made by :func:`memory_pair`."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._peer: MemoryEnd = self
        self._outbox = Outbox(name)
        self._arrived = bytearray()
        self._readable: asyncio.Future[None] | None = None
        self._lost = ""

    @property
    def name(self) -> str:
        """What :func:`memory_pair` was told."""
        return self._name

    async def read(self) -> bytes:
        """Return the next bytes, at least one; TransportError when the line is gone."""
        while not self._arrived:
            self._check()  # after what arrived: bytes outlive their line here, as in a kernel's buffer
            self._readable = asyncio.get_running_loop().create_future()
            try:
                await self._readable
            finally:
                self._readable = None
        data = bytes(self._arrived)
        self._arrived.clear()
        self._peer._flush()  # noqa: SLF001  # the two ends are one object in two halves
        return data

    def write(self, data: bytes) -> None:
        """Queue bytes; TransportError when the line is gone or its buffer is full."""
        self._check()
        self._outbox.put(data)
        self._flush()

    def write_urgent(self, data: bytes) -> None:
        """Queue bytes in place of everything not yet written; TransportError when the line is gone."""
        self._check()
        self._outbox.put_urgent(data)
        self._flush()

    def write_past_loop(self, data: bytes) -> None:
        """Do nothing: both ends live in the loop."""

    def close(self) -> None:
        """Give the line up; the other end may still read what was written before."""
        self._lose("closed")
        self._arrived.clear()
        self._peer._lose("the other side hung up")  # noqa: SLF001  # as above

    def cut(self) -> None:
        """Cut the line: what is under way is gone, and both ends find out at once."""
        for end in (self, self._peer):
            end._arrived.clear()  # noqa: SLF001  # as above
            end._lose("the line was cut")  # noqa: SLF001  # as above

    def _flush(self) -> None:
        while self._outbox and (room := _WIRE_BYTES - len(self._peer._arrived)):  # noqa: SLF001  # as above
            piece = self._outbox.head()[:room]
            self._outbox.drop(len(piece))
            self._peer._arrive(piece)  # noqa: SLF001  # as above

    def _arrive(self, data: bytes) -> None:
        self._arrived += data
        self._wake()

    def _lose(self, reason: str) -> None:
        if not self._lost:
            self._lost = reason
            self._outbox.clear()
            self._wake()

    def _wake(self) -> None:
        if self._readable is not None and not self._readable.done():
            self._readable.set_result(None)

    def _check(self) -> None:
        if self._lost:
            raise TransportError(f"{self._name}: {self._lost}")


def memory_pair(name: str = "memory") -> tuple[MemoryEnd, MemoryEnd]:
    """Return the two ends of a new line."""
    near, far = MemoryEnd(name), MemoryEnd(name)
    near._peer, far._peer = far, near  # noqa: SLF001  # as above
    return near, far
