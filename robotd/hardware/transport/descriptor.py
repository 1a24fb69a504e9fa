"""What serial port, pseudo-terminal and TCP share: a non-blocking descriptor on the event loop."""

import asyncio
import contextlib
import os
import threading
from collections.abc import Callable

from robotd.core.errors import TransportError
from robotd.hardware.transport.descriptor_readiness import Readiness
from robotd.hardware.transport.outbox import Outbox

_READ_BYTES = 4096
"""What the kernel holds for a terminal: one call takes it all."""


class DescriptorTransport:
    """A transport over a non-blocking descriptor.

    The descriptor is watched only while somebody reads or something waits to be written: the kernel's
    buffer is the only input buffer, and a line that hung up cannot keep the loop busy.
    """

    def __init__(self, name: str, descriptor: int, readiness: Readiness, release: Callable[[], None]) -> None:
        """Take over a descriptor; ``readiness`` tells when it can be used, ``release`` closes it."""
        self._name = name
        self._descriptor = descriptor
        self._readiness = readiness
        self._release = release
        self._loop = asyncio.get_running_loop()
        self._outbox = Outbox(name)
        self._readable: asyncio.Future[None] | None = None
        self._lost: str | None = None
        self._closing = threading.Lock()

    @property
    def name(self) -> str:
        """Path or address, for people."""
        return self._name

    async def read(self) -> bytes:
        """Return the next bytes, at least one; TransportError when the line is gone."""
        while True:
            await self._wait_readable()
            try:
                data = os.read(self._descriptor, _READ_BYTES)
            except (BlockingIOError, InterruptedError):  # that it is ready is a hint, no promise
                continue
            except OSError as error:
                # Round again, for the end of a pseudo-terminal does not end with those who opened it: waiting tells.
                self._hang_up(f"read: {error.strerror}")
                continue
            if data:
                return data
            self._hang_up("the other side hung up")

    def write(self, data: bytes) -> None:
        """Queue bytes; TransportError when the line is gone or its buffer is full."""
        self._check()
        self._outbox.put(data)
        self._flush()
        self._check()  # the write itself may have found that the line is gone

    def write_urgent(self, data: bytes) -> None:
        """Queue bytes in place of everything not yet written; TransportError when the line is gone."""
        self._check()
        # In place of what waits, not before it: set-points that follow a stop would undo it.
        self._outbox.put_urgent(data)
        self._flush()
        self._check()

    def write_past_loop(self, data: bytes) -> None:
        """Write bytes at once, from any thread; what does not fit into the kernel's buffer is lost."""
        # Past the outbox, which is the loop's and no thread's.
        with self._closing, contextlib.suppress(OSError):
            if self._lost is None:
                os.write(self._descriptor, data)

    def close(self) -> None:
        """Give the line up; a pending :meth:`read` raises TransportError."""
        self._lose("closed")

    async def _wait_readable(self) -> None:
        self._check()
        self._readable = self._loop.create_future()
        self._watch(self._readable)
        try:
            await self._readable
        finally:
            self._readable = None
            self._readiness.forget_readable()
        self._check()

    def _watch(self, readable: "asyncio.Future[None]") -> None:
        self._readiness.when_readable(lambda: wake(readable))

    def _flush(self) -> None:
        try:
            # Now, not when the loop says that there is room: a stop does not wait for its turn.
            while self._outbox:
                self._outbox.drop(os.write(self._descriptor, self._outbox.head()))
        except (BlockingIOError, InterruptedError):
            self._readiness.when_writable(self._flush)
            return
        except OSError as error:
            self._hang_up(f"write: {error.strerror}")
            return
        self._readiness.forget_writable()

    def _hang_up(self, reason: str) -> None:
        self._lose(reason)

    def _check(self) -> None:
        if self._lost is not None:
            raise TransportError(f"{self._name}: {self._lost}")

    def _lose(self, reason: str) -> None:
        if self._lost is not None:
            return
        self._lost = reason
        self._readiness.close()
        self._outbox.clear()
        with self._closing:  # another thread must not write to whatever gets this number next
            self._release()
        if self._readable is not None:
            wake(self._readable)


def wake(readable: "asyncio.Future[None]") -> None:
    """Let a pending read go on."""
    if not readable.done():
        readable.set_result(None)
