"""Between two processes, or two halves of one: whole messages, in order, and never a wait to send one."""

import asyncio
from collections import deque
from collections.abc import Iterator, Sequence
from typing import Protocol

from robotd.core.errors import ChildError

Part = bytes | bytearray | memoryview
Message = bytes | memoryview
"""A long one is a view of the memory into which it arrived: a map is not copied on the loop to be received."""
ROOM_BYTES = 2**27
"""What may wait to leave, or to be taken: twice the largest map."""


class HungUp(ChildError):
    """There is nothing more to receive: an end is gone."""


class Channel(Protocol):
    """One end of a channel.

    What waits is bounded on both sides. An end that does not take its messages makes the other's :meth:`send` say
    False, and what was said True to arrives whole and in order, unless an end goes.
    """

    def send(self, *parts: Part) -> bool:
        """Send one message made of these parts, and return at once; False if there is no room or nobody there.

        Parts must not be changed until they have left, which may be later.
        """

    async def receive(self) -> Message:
        """Wait for the next message.

        Raises:
            HungUp: there is none to come, since an end is gone; what was sent before has then been received.
            ChildError: the other end sent what is no message.
        """

    async def room(self) -> None:
        """Wait until less than half of what may wait to leave waits.

        Raises:
            HungUp: an end is gone.
        """

    def close(self) -> None:
        """Give the channel up; messages that arrived already may still be received."""


class Inbox:
    """What arrived and was not received yet."""

    def __init__(self) -> None:
        self.bytes = 0
        """Of all that waits."""
        self._messages: deque[Message] = deque()
        self._lost: ChildError | None = None
        self._news = asyncio.Event()

    def put(self, message: Message) -> None:
        """Let a message wait."""
        self._messages.append(message)
        self.bytes += len(message)
        self._news.set()

    def lose(self, reason: ChildError) -> None:
        """Note that no more will come; the first reason counts."""
        # What comes first is the cause; that the socket is closed after it only follows.
        self._lost = self._lost or reason
        self._news.set()

    async def get(self) -> Message:
        """Wait for a message; ChildError if none is to come."""
        while not self._messages:
            # Asked only when nothing waits: what was sent before the end is received first.
            if self._lost is not None:
                raise self._lost
            self._news.clear()
            await self._news.wait()
        message = self._messages.popleft()
        self.bytes -= len(message)
        return message


class Outgoing:
    """What waits to leave: parts of messages, within bounds."""

    def __init__(self, room_bytes: int) -> None:
        self.bytes = 0
        self._room_bytes = room_bytes
        self._parts: deque[memoryview] = deque()

    def put(self, parts: Sequence[Part]) -> bool:
        """Let all of these wait, or none of them; return which."""
        # Views, not one joined message: a map of megabytes is not copied on the loop to be sent.
        views = [memoryview(part).cast("B") for part in parts if len(part)]
        length = sum(view.nbytes for view in views)
        # All or none: half a message would leave the other end out of step for good.
        if self.bytes + length > self._room_bytes:
            return False
        self._parts.extend(views)
        self.bytes += length
        return True

    def pieces(self, most: int) -> Iterator[memoryview]:
        """Yield what is to leave next, at most ``most`` pieces."""
        for index in range(min(most, len(self._parts))):
            yield self._parts[index]

    def drop(self, count: int) -> None:
        """Forget the first ``count`` bytes: they have left."""
        self.bytes -= count
        while count:
            first = self._parts[0]
            if first.nbytes > count:
                # The kernel takes as much as it has room for, which seldom ends where a part does.
                self._parts[0] = first[count:]
                return
            count -= first.nbytes
            self._parts.popleft()

    @property
    def is_half_empty(self) -> bool:
        """Whether there is room for much more."""
        return self.bytes * 2 <= self._room_bytes
