"""What clients ask, a request of each in turn, and the answers on their way back.

Nobody is served twice while somebody else waits: a client that pours in requests has as large a share as one that asks
for one thing. What looks like a stop or a renewal has every second turn: it waits for no more than one such request of
each other client, and as many others.
"""

import asyncio
import re
from collections import deque
from dataclasses import dataclass, replace
from itertools import count

from robotd.server.client_connection import Connection
from robotd.server.zmtp import message

_LAST_BYTES = 2**23
"""Of what clients asked before they left, and nobody has read yet."""
_SHOWN = 10
"""Digits of an identity that tell clients apart in a log."""
_URGENT = re.compile(rb"stop|disarm|renew", re.IGNORECASE)
_LOOKED_AT_BYTES = 256
"""Of a request, for such a word. It is a guess, and only about whose turn it is."""


@dataclass(frozen=True, slots=True)
class Letter:
    """What one client sent."""

    route: tuple[bytes, ...]
    """What goes before the answer: the client's identity, and the empty frame if it put one before its request."""
    frames: tuple[bytes, ...]
    """The request itself; one frame, as it should be."""
    sender: str
    """Who it was, for the log."""

    @property
    def identity(self) -> bytes:
        """What tells this client from the others."""
        return self.route[0]

    def signed(self, name: str) -> "Letter":
        """Return it as one whose sender has a name, or as it is if that is empty."""
        return replace(self, sender=f"{name}, {self.sender}") if name else self


class Letters:
    """Receives and answers."""

    def __init__(self) -> None:
        self._connections: dict[bytes, Connection] = {}
        self._asked: dict[Connection, deque[Letter]] = {}
        """What was read of those who are here; whose turn is next stands first."""
        self._urgent: dict[Connection, None] = {}
        """Those of them who asked for what must not wait, in the order of their turns."""
        self._was_urgent = False
        self._left: deque[Letter] = deque()
        """What was asked by those who have gone since: a program that stops the robot and ends is obeyed."""
        self._left_bytes = 0
        self._nameless = count(1)
        self._news = asyncio.Event()

    def joined(self, connection: Connection) -> None:
        """Know a client by its name; one that comes again by the same name takes the place of the one before."""
        # As libzmq names them: a zero first, which no client may choose.
        connection.identity = connection.identity or b"\0" + next(self._nameless).to_bytes(8, "big")
        before = self._connections.get(connection.identity)
        self._connections[connection.identity] = connection
        if before is not None:
            before.close()

    def heard(self, connection: Connection, frames: tuple[bytes, ...]) -> None:
        """Let a request wait for its turn; until it had it, no more is read of this client."""
        asked = self._asked.setdefault(connection, deque())
        asked.append(_letter(connection, frames))
        if _URGENT.search(frames[-1], 0, _LOOKED_AT_BYTES):
            self._urgent[connection] = None
        # What it sends further waits in the kernel, which stops it by itself when that is full.
        connection.listen(to_it=False)
        self._news.set()

    def overheard(self, connection: Connection, frames: tuple[bytes, ...]) -> None:
        """Let what came of a request that was cut off be looked at: it may speak of a stop."""
        self._put_by(_letter(connection, (*frames, b"")))  # one frame more: it is none that is carried out

    def left(self, connection: Connection) -> None:
        """Forget a client, but for what it asked."""
        if self._connections.get(connection.identity) is connection:
            del self._connections[connection.identity]
        self._urgent.pop(connection, None)
        for letter in self._asked.pop(connection, ()):
            self._put_by(letter)

    async def receive(self) -> Letter:
        """Wait for the next request."""
        while not (self._left or self._asked):
            self._news.clear()
            await self._news.wait()
        # Those who have gone first: they are few, and nothing else will ever remind anybody of them.
        if self._left:
            letter = self._left.popleft()
            self._left_bytes -= _size(letter)
            return letter
        connection = self._whose_turn()
        asked = self._asked.pop(connection)
        letter = asked.popleft()
        if asked:
            self._asked[connection] = asked  # behind all others
        else:
            connection.listen(to_it=True)
        return letter

    def _whose_turn(self) -> Connection:
        self._was_urgent = bool(self._urgent) and not self._was_urgent
        connection = next(iter(self._urgent if self._was_urgent else self._asked))
        self._urgent.pop(connection, None)
        return connection

    def answer(self, route: tuple[bytes, ...], reply: bytes) -> None:
        """Answer; what cannot be sent is lost, as to a client that has gone, which will ask again."""
        identity, *envelope = route
        connection = self._connections.get(identity)
        if connection is not None:
            connection.send(message(*envelope, reply))

    def _put_by(self, letter: Letter) -> None:
        self._left.append(letter)
        self._left_bytes += _size(letter)
        while self._left_bytes > _LAST_BYTES:
            self._left_bytes -= _size(self._left.popleft())
        self._news.set()


def _size(letter: Letter) -> int:
    return sum(map(len, letter.frames))


def _letter(connection: Connection, frames: tuple[bytes, ...]) -> Letter:
    return letter(connection.identity, frames, f" ({connection.process})")


def letter(identity: bytes, frames: tuple[bytes, ...], process: str) -> Letter:
    """Return what a client sent as what it is: with the envelope of a REQ socket, or without."""
    is_enveloped = len(frames) > 1 and frames[0] == b""
    envelope, request = ((b"",), frames[1:]) if is_enveloped else ((), frames)
    return Letter((identity, *envelope), request, f"client {identity.hex()[:_SHOWN]}{process}")
