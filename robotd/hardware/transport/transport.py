"""What a line of bytes can do, whatever it is made of."""

from collections.abc import Awaitable, Callable
from typing import Protocol


class Transport(Protocol):
    """An open line. Reading yields chunks as they come; where frames begin is not its business."""

    @property
    def name(self) -> str:
        """Path or address, for people."""

    async def read(self) -> bytes:
        """Return the next bytes, at least one.

        Raises:
            TransportError: the line is gone.
        """

    def write(self, data: bytes) -> None:
        """Queue bytes; returns at once.

        Raises:
            TransportError: the line is gone, or its bounded buffer is full.
        """

    def write_urgent(self, data: bytes) -> None:
        """Queue bytes in place of everything not yet written, whatever the bound.

        Raises:
            TransportError: the line is gone.
        """

    def write_past_loop(self, data: bytes) -> None:
        """Write bytes at once, past the queue and past the event loop: for a stop while the loop is stuck.

        May be called from any thread; never blocks, never raises. A line that lives in the loop alone does nothing.
        """

    def close(self) -> None:
        """Give the line up; closing twice is fine. A pending :meth:`read` raises TransportError."""


Connect = Callable[[], Awaitable[Transport]]
"""Opens the line again, each time it is called; raises TransportError when that fails."""
