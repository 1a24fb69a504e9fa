"""Bytes that wait to be written: bounded, with a lane for those that cannot wait.

Urgent bytes are a stop, and a stop is the last word: whatever waited behind it was meant for a robot that may move, an
ARM among it, and must not come after. So it is thrown away; a frame that is cut in half by this is damaged bytes to the
board, which is in step again with the stop.
"""

from robotd.core.errors import TransportError

OUTBOX_LIMIT_BYTES = 64 * 1024
"""Nearly six seconds of a line of 115200 baud: what waits longer has waited too long to be obeyed."""


class Outbox:
    """Two queues; the urgent one goes first and has no bound, as only a stop travels in it."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._urgent = bytearray()
        self._waiting = bytearray()

    def __len__(self) -> int:
        return len(self._urgent) + len(self._waiting)

    def put(self, data: bytes) -> None:
        """Queue bytes, all or none.

        Raises:
            TransportError: they would exceed ``OUTBOX_LIMIT_BYTES``.
        """
        if len(self._waiting) + len(data) > OUTBOX_LIMIT_BYTES:
            raise TransportError(f"{self._name}: {len(self._waiting)} bytes wait to be written, the line is stuck")
        self._waiting += data

    def put_urgent(self, data: bytes) -> None:
        """Queue bytes in place of all others that wait, behind earlier urgent ones."""
        self._waiting.clear()
        self._urgent += data

    def head(self) -> bytes:
        """Return the bytes to write next."""
        return bytes(self._urgent or self._waiting)

    def drop(self, count: int) -> None:
        """Forget the first ``count`` bytes of :meth:`head`: they are written."""
        del (self._urgent or self._waiting)[:count]

    def clear(self) -> None:
        """Forget everything."""
        self._urgent.clear()
        self._waiting.clear()
