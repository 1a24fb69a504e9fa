"""A channel within one process: for tests and replays, on whatever clock their loop has."""

import asyncio

from robotd.children.channel import ROOM_BYTES, HungUp, Inbox, Message, Part


class MemoryChannel:
    """One end. Made by :func:`memory_channel`."""

    def __init__(self, room_bytes: int) -> None:
        self._inbox = Inbox()
        self._room_bytes = room_bytes
        self._peer: MemoryChannel | None = None
        self._taken = asyncio.Event()

    def send(self, *parts: Part) -> bool:
        """Send one message; False if the other end has too much to take already, or is gone."""
        message = b"".join(parts)  # copied, as a socket would: the sender may go on to change what it sent
        if self._peer is None or self._peer._inbox.bytes + len(message) > self._room_bytes:  # noqa: SLF001  # the two ends are one object in two halves
            return False
        self._peer._inbox.put(message)  # noqa: SLF001  # as above
        return True

    async def receive(self) -> Message:
        """Wait for the next message; HungUp if an end is gone."""
        message = await self._inbox.get()
        if self._peer is not None:
            self._peer._taken.set()  # noqa: SLF001  # as above
        return message

    async def room(self) -> None:
        """Wait until the other end has less than half of what may wait; HungUp if an end is gone."""
        while self._peer is not None and self._peer._inbox.bytes * 2 > self._room_bytes:  # noqa: SLF001  # as above
            self._taken.clear()
            await self._taken.wait()
        if self._peer is None:
            raise HungUp("the other end is gone")

    def close(self) -> None:
        """Give the channel up."""
        peer, self._peer = self._peer, None
        # Both ends are told, as a socket's are: the one that closes may have a task that still receives.
        self._inbox.lose(HungUp("it was closed"))
        self._taken.set()
        if peer is not None:
            peer._peer = None  # noqa: SLF001  # as above
            peer._inbox.lose(HungUp("the other end is gone"))  # noqa: SLF001  # as above
            peer._taken.set()  # noqa: SLF001  # as above


def memory_channel(room_bytes: int = ROOM_BYTES) -> tuple[MemoryChannel, MemoryChannel]:
    """Return the two ends of a new channel."""
    near, far = MemoryChannel(room_bytes), MemoryChannel(room_bytes)
    near._peer, far._peer = far, near  # noqa: SLF001  # as above
    return near, far
