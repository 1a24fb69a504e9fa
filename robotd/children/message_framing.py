"""Messages in a stream of bytes, and back: four bytes of length, least first, then the message."""

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
        self._waiting = bytearray()

    def feed(self, data: bytes) -> Iterator[bytes]:
        """Yield the messages that are whole now.

        Raises:
            RemoteProtocolError: a message says that it is longer than messages may be; nothing after it can be read.
        """
        self._waiting += data
        while len(self._waiting) >= _LENGTH:
            length = int.from_bytes(self._waiting[:_LENGTH], "little")
            if length > self._longest:
                raise RemoteProtocolError(f"a message of {length} bytes, expected at most {self._longest}")
            if len(self._waiting) < _LENGTH + length:
                return
            message = bytes(memoryview(self._waiting)[_LENGTH : _LENGTH + length])
            del self._waiting[: _LENGTH + length]
            yield message
