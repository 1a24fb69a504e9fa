"""One connection of a client: what it sends, bit by bit, and what waits until it takes it."""

import asyncio
import logging
import socket
import struct
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

from robotd.server.zmtp import GREETING, Message, Peer, Ping, Reader, Said, Violation, pong, ready

log = logging.getLogger(__name__)

_READ_BYTES = 16384
"""At most, each time that there is something: all others have their turn between."""
_PIECES = 16
_GREETS_WITHIN_S = 5.0
_CREDENTIALS = struct.Struct("3i")


@dataclass(frozen=True, slots=True)
class PeerProcess:
    """Who is at the other end, as the kernel knows it."""

    pid: int
    uid: int

    def __str__(self) -> str:
        return f"uid {self.uid}, pid {self.pid}"


@dataclass(frozen=True, slots=True)
class Manners:
    """What a listening socket expects of those who connect, and gives them."""

    socket_type: bytes
    peers: frozenset[bytes]
    """Types of sockets that may connect."""
    longest_bytes: int
    """Of a message that is read."""
    most_frames: int
    queue: int
    """Messages that wait to be taken; what comes after them is lost to this client."""
    queue_bytes: int
    """The same in bytes, unless it is one message alone."""


class Owner(Protocol):
    """Who is told of what comes over connections."""

    def joined(self, connection: "Connection") -> None:
        """Take note of one whose peer has said who it is."""

    def heard(self, connection: "Connection", frames: tuple[bytes, ...]) -> None:
        """Take a message; a Violation cuts the connection off."""

    def overheard(self, connection: "Connection", frames: tuple[bytes, ...]) -> None:
        """Take what came of a message that broke a bound."""

    def left(self, connection: "Connection") -> None:
        """Forget it."""


class Connection:
    """A connection, until it is cut off or the client leaves."""

    def __init__(
        self, end: socket.socket, manners: Manners, owner: Owner, gone: Callable[["Connection", str], None]
    ) -> None:
        """Greet the client.

        Args:
            end: its socket.
            manners: what is expected of it.
            owner: told of what it says.
            gone: told when it is over, and why, if it was cut off.
        """
        end.setblocking(False)
        self.process = process_of(end)
        self.identity = b""
        self.waiting_bytes = 0
        self._socket: socket.socket | None = end
        self._loop = asyncio.get_running_loop()
        self._manners = manners
        self._owner = owner
        self._gone = gone
        self._reader = Reader(longest_bytes=manners.longest_bytes, most_frames=manners.most_frames)
        self._outgoing: deque[memoryview] = deque()
        self._says: Iterator[Said] | None = None
        """What was read, and not taken yet."""
        self._is_wanted = True
        self._takes_nothing = False
        self._is_known = False
        self._is_writing = False
        self._loop.add_reader(end, self._read)
        # Who never greets would keep a place that others wait for.
        self._too_late = self._loop.call_later(_GREETS_WITHIN_S, self._greeted_too_late)
        self._put(GREETING + ready(manners.socket_type))

    @property
    def is_open(self) -> bool:
        """Whether it is not over."""
        return self._socket is not None

    def send(self, data: bytes) -> bool:
        """Let a message wait to be taken; False if too much waits already, so that this client misses it."""
        # One message alone always has room: a map may be larger than all that may wait.
        is_full = self.waiting_bytes > 0 and (
            len(self._outgoing) >= self._manners.queue or self.waiting_bytes + len(data) > self._manners.queue_bytes
        )
        if self._socket is None or self._takes_nothing or is_full:
            return False
        self._put(data)
        return True

    def listen(self, *, to_it: bool) -> None:
        """Read on, or leave what was read as it is, and in the kernel what comes, until it is wanted."""
        self._is_wanted = to_it
        if self._socket is None:
            return
        if not to_it:
            self._loop.remove_reader(self._socket)
        elif self._says is None:
            self._loop.add_reader(self._socket, self._read)
        else:
            self._loop.call_soon(self._hear)

    def close(self, why: str = "") -> None:
        """End it; cut off if there is a reason."""
        end, self._socket = self._socket, None
        if end is None:
            return
        self._too_late.cancel()
        self._loop.remove_reader(end)
        self._loop.remove_writer(end)
        end.close()
        self._outgoing.clear()
        self.waiting_bytes = 0
        if self._is_known:
            self._owner.left(self)
        self._gone(self, why)

    def _is_heard(self) -> bool:
        return self._socket is not None and self._is_wanted

    def _greeted_too_late(self) -> None:
        self.close(f"it did not say what it is within {_GREETS_WITHIN_S:g} s")

    def _read(self) -> None:
        if self._socket is None:
            return
        try:
            data = self._socket.recv(_READ_BYTES)
        except (BlockingIOError, InterruptedError):
            return
        except OSError:
            data = b""
        if not data:
            self.close()
            return
        # An iterator and not a list: a client that is not wanted now is left in the middle of what it said.
        self._says = self._reader.feed(data)
        self._hear()

    def _hear(self) -> None:
        """Take what it says one by one, for as long as it is wanted."""
        if self._says is None or not self._is_heard():
            return
        try:
            for said in self._says:
                self._take(said)
                if not self._is_heard():
                    return
            self._says = None
            self.listen(to_it=True)
        except Violation as violation:
            # What came before the fault is looked at all the same: it may have been a stop.
            if violation.frames:
                self._owner.overheard(self, violation.frames)
            self.close(str(violation))
        except Exception:  # a mistake of ours in what one client brings about must not meet the others
            log.exception("a client (%s)", self.process)
            self.close("what it sent was more than could be read")

    def _take(self, said: Peer | Message | Ping) -> None:
        match said:
            case Message(frames):
                self._owner.heard(self, frames)
            case Ping():
                self.send(pong(said))
            case Peer(socket_type, identity):
                if socket_type not in self._manners.peers:
                    raise Violation(f"a socket of type {socket_type!r} has no place here")
                self._too_late.cancel()
                self.identity = identity
                self._is_known = True
                self._owner.joined(self)

    def _put(self, data: bytes) -> None:
        self._outgoing.append(memoryview(data))
        self.waiting_bytes += len(data)
        if not self._is_writing:
            self._write()

    def _write(self) -> None:
        if self._socket is None:
            return
        try:
            count = self._socket.sendmsg([self._outgoing[index] for index in range(min(_PIECES, len(self._outgoing)))])
        except (BlockingIOError, InterruptedError):
            count = 0
        except OSError:
            # It takes nothing any more; what it asked before it went, a stop among it, is still to be read.
            self._takes_nothing = True
            self._outgoing.clear()
            self.waiting_bytes = count = 0
        self._taken(count)
        is_more = bool(self._outgoing)
        if is_more and not self._is_writing:
            self._loop.add_writer(self._socket, self._write)
        elif not is_more and self._is_writing:
            self._loop.remove_writer(self._socket)
        self._is_writing = is_more

    def _taken(self, count: int) -> None:
        self.waiting_bytes -= count
        while count:
            first = self._outgoing[0]
            if first.nbytes > count:
                self._outgoing[0] = first[count:]
                return
            count -= first.nbytes
            self._outgoing.popleft()


def process_of(end: socket.socket) -> PeerProcess:
    """Return which process is at the other end of a Unix socket."""
    pid, uid, _ = _CREDENTIALS.unpack(end.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size))
    return PeerProcess(pid, uid)
