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
        self._rest = memoryview(b"")
        """Came after the last whole message, and is less than one."""
        self._long: memoryview | None = None
        """The message that is on its way, if it is longer than what was there when it began."""
        self._filled = 0
        """Of that."""

    def feed(self, data: bytes) -> Iterator[bytes | memoryview]:
        """Yield the messages that are whole now.

        One that came in pieces is a view of memory of its own, into which each piece went as it came: to join a map of
        megabytes once it is whole would keep the loop for all of it.

        Raises:
            RemoteProtocolError: a message says that it is longer than messages may be; nothing after it can be read.
        """
        came = memoryview(data)
        if self._long is not None:
            came = self._fill(self._long, came)
            if self._filled < len(self._long):
                return
            whole, self._long = self._long.toreadonly(), None
            yield whole
        self._rest = memoryview(bytes(self._rest) + came) if self._rest else came
        while len(self._rest) >= _LENGTH:
            length = int.from_bytes(self._rest[:_LENGTH], "little")
            # At once: what says that it has four gigabytes must not be waited for, or held.
            if length > self._longest:
                raise RemoteProtocolError(f"a message of {length} bytes, expected at most {self._longest}")
            self._rest = self._rest[_LENGTH:]
            if len(self._rest) < length:
                self._long, self._filled = memoryview(bytearray(length)), 0
                self._rest = self._fill(self._long, self._rest)
                return
            yield bytes(self._rest[:length])
            self._rest = self._rest[length:]

    def _fill(self, message: memoryview, came: memoryview) -> memoryview:
        """Add to a message what belongs to it; return what is left over."""
        taken = min(len(message) - self._filled, len(came))
        message[self._filled : self._filled + taken] = came[:taken]
        self._filled += taken
        return came[taken:]
