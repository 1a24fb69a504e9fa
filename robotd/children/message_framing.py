"""Messages in a stream of bytes, and back: four bytes of length, least first, then the message."""

from collections import deque
from collections.abc import Iterator

from robotd.core.errors import RemoteProtocolError

LONGEST = 2**27
"""Bytes of one message: twice the largest map, a byte a cell."""
_LENGTH = 4


def header(length: int) -> bytes:
    """Return what goes before a message of this length [bytes]."""
    return length.to_bytes(_LENGTH, "little")


class Unframer:
    """Takes bytes as they come, in whatever pieces, and gives whole messages."""

    def __init__(self, longest: int = LONGEST) -> None:
        """Refuse messages of more than ``longest`` bytes, before any room is made for them."""
        self._longest = longest
        # Pieces, put together when a message is whole: a map's bytes are copied once, not with every piece.
        self._pieces: deque[memoryview] = deque()
        self._held = 0
        self._length: int | None = None
        """Of the message that is on its way, once its first bytes are here."""

    def feed(self, data: bytes) -> Iterator[bytes]:
        """Yield the messages that are whole now.

        Raises:
            RemoteProtocolError: a message says that it is longer than messages may be; nothing after it can be read.
        """
        self._pieces.append(memoryview(data))
        self._held += len(data)
        while (message := self._next()) is not None:
            yield message

    def _next(self) -> bytes | None:
        if self._length is None:
            if self._held < _LENGTH:
                return None
            self._length = int.from_bytes(self._taken(_LENGTH), "little")
            # At once: what says that it has four gigabytes must not be waited for, or held.
            if self._length > self._longest:
                raise RemoteProtocolError(f"a message of {self._length} bytes, expected at most {self._longest}")
        if self._held < self._length:
            return None
        message = self._taken(self._length)
        self._length = None
        return message

    def _taken(self, count: int) -> bytes:
        """Return the next ``count`` bytes, which are here."""
        self._held -= count
        taken: list[memoryview] = []
        while count:
            piece = self._pieces.popleft()
            if piece.nbytes > count:
                self._pieces.appendleft(piece[count:])
                piece = piece[:count]
            taken.append(piece)
            count -= piece.nbytes
        return b"".join(taken)
