"""ZMTP 3.0, the bytes of ZeroMQ's sockets (https://rfc.zeromq.org/spec/23), as far as a server needs them. Pure.

A peer greets, says what kind of socket it is, and then sends messages of one or more frames. What it sends is bounded
before there is room made for it: bytes and frames of a message, and what it may say of itself.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from robotd.core.errors import RemoteProtocolError

_MORE, _LONG, _COMMAND = 1, 2, 4
_SHORT_LENGTHS = 256
_MAJOR = 3
_MECHANISM = b"NULL"
_GREETING_BYTES = 64
_LONGEST_COMMAND = 512
_LONGEST_IDENTITY = 255
GREETING = b"\xff" + bytes(8) + b"\x7f" + bytes((_MAJOR, 0)) + _MECHANISM.ljust(20, b"\0") + bytes(32)
"""Version 3.0: a newer peer speaks it as well."""


@dataclass(frozen=True, slots=True)
class Peer:
    """What the other side says of itself, once."""

    socket_type: bytes
    identity: bytes


@dataclass(frozen=True, slots=True)
class Message:
    """One message: what an application sent, or a subscription."""

    frames: tuple[bytes, ...]


@dataclass(frozen=True, slots=True)
class Ping:
    """Asks for :func:`pong`."""

    context: bytes


class Violation(RemoteProtocolError):
    """A peer that breaks the rules, or a bound; nothing more of it can be read."""

    def __init__(self, message: str, frames: tuple[bytes, ...] = ()) -> None:
        super().__init__(message)
        self.frames = frames
        """Of the message that it was about to send."""


Said = Peer | Message | Ping


def message(*frames: bytes) -> bytes:
    """Return the bytes of a message of these frames, the flags between them included."""
    last = len(frames) - 1
    return b"".join(_header(len(frame), _MORE if index < last else 0) + frame for index, frame in enumerate(frames))


def ready(socket_type: bytes) -> bytes:
    """Return what follows the greeting."""
    return _command(b"READY", _property(b"Socket-Type", socket_type) + _property(b"Identity", b""))


def pong(ping: Ping) -> bytes:
    """Return the answer to a ping."""
    return _command(b"PONG", ping.context)


def _command(name: bytes, body: bytes) -> bytes:
    whole = bytes((len(name),)) + name + body
    return _header(len(whole), _COMMAND) + whole


def _property(name: bytes, value: bytes) -> bytes:
    return bytes((len(name),)) + name + len(value).to_bytes(4, "big") + value


def _header(length: int, flags: int) -> bytes:
    if length < _SHORT_LENGTHS:
        return bytes((flags, length))
    return bytes((flags | _LONG,)) + length.to_bytes(8, "big")


class Reader:
    """Takes bytes as they come, and gives what the peer says."""

    def __init__(self, *, longest_bytes: int, most_frames: int) -> None:
        """Refuse messages of more bytes or frames than these."""
        self._longest_bytes = longest_bytes
        self._most_frames = most_frames
        self._waiting = bytearray()
        self._frames: list[bytes] = []
        self._is_greeted = False
        self._is_known = False

    def feed(self, data: bytes) -> Iterator[Said]:
        """Yield what is whole now.

        Raises:
            Violation: the peer speaks something else, or too much.
        """
        self._waiting += data
        if not self._is_greeted:
            self._greet()
        if not self._is_greeted:
            return
        # What is whole is cut off once for all of it: a deletion for each message would move the rest as often.
        at = 0
        try:
            while (found := self._frame(at)) is not None:
                flags, begins, ends = found
                at = ends
                said = self._take(flags, bytes(self._waiting[begins:ends]))
                if said is not None:
                    yield said
        finally:
            del self._waiting[:at]

    def _greet(self) -> None:
        greeting = self._waiting
        if (greeting and greeting[0] != GREETING[0]) or (len(greeting) > 9 and not greeting[9] & 1):
            raise Violation("it does not speak ZeroMQ's protocol")
        if len(greeting) > 10 and greeting[10] < _MAJOR:
            raise Violation(f"it speaks version {greeting[10]} of ZeroMQ's protocol, expected {_MAJOR}")
        if len(greeting) < _GREETING_BYTES:
            return
        if (mechanism := bytes(greeting[12:32]).rstrip(b"\0")) != _MECHANISM:
            raise Violation(f"it wants security by {mechanism!r}, there is none but who may open the socket")
        del greeting[:_GREETING_BYTES]
        self._is_greeted = True

    def _frame(self, at: int) -> tuple[int, int, int] | None:
        """Return flags, beginning and end of the frame that begins at ``at``, or None if it is not whole."""
        waiting = self._waiting
        if len(waiting) < at + 2:
            return None
        flags = waiting[at]
        size = 9 if flags & _LONG else 2
        if flags & ~(_MORE | _LONG | _COMMAND):
            raise Violation(f"a frame with flags {flags:#x}", tuple(self._frames))
        if len(waiting) < at + size:
            return None
        length = int.from_bytes(waiting[at + 1 : at + size], "big")
        self._check(flags, length)
        begins = at + size
        return (flags, begins, begins + length) if len(waiting) >= begins + length else None

    def _check(self, flags: int, length: int) -> None:
        if flags & _COMMAND:
            if length > _LONGEST_COMMAND:
                raise Violation(f"a command of {length} bytes, expected at most {_LONGEST_COMMAND}")
            return
        whole = length + sum(map(len, self._frames))
        if whole > self._longest_bytes:
            raise Violation(f"a message of {whole} bytes, expected at most {self._longest_bytes}", tuple(self._frames))
        if len(self._frames) >= self._most_frames:
            raise Violation(f"a message of more than {self._most_frames} frames", tuple(self._frames))

    def _take(self, flags: int, body: bytes) -> Said | None:
        if flags & _COMMAND:
            return self._take_command(body)
        if not self._is_known:
            raise Violation("a message from a peer that has not said what it is")
        self._frames.append(body)
        if flags & _MORE:
            return None
        frames, self._frames = tuple(self._frames), []
        return Message(frames)

    def _take_command(self, body: bytes) -> Said | None:
        name, rest = body[1 : 1 + body[0]] if body else b"", body[1 + body[0] :] if body else b""
        if name == b"READY" and not self._is_known:
            self._is_known = True
            properties = _properties(rest)
            return Peer(properties.get(b"socket-type", b""), properties.get(b"identity", b"")[:_LONGEST_IDENTITY])
        if name == b"PING" and self._is_known:
            return Ping(rest[2:18])
        if name == b"PONG" and self._is_known:
            return None
        raise Violation(f"command {name[:20]!r}, which nobody expects here")


def _properties(data: bytes) -> dict[bytes, bytes]:
    found: dict[bytes, bytes] = {}
    while data:
        name, data = data[1 : 1 + data[0]], data[1 + data[0] :]
        length = int.from_bytes(data[:4], "big")
        if len(data) < 4 + length:
            raise Violation("a property without its end")
        found[name.lower()], data = data[4 : 4 + length], data[4 + length :]
    return found
