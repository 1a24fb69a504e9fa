"""A channel over one socket of a pair, on the running loop."""

import asyncio
import socket

from robotd.children.channel import ROOM_BYTES, HungUp, Inbox, Message, Outgoing, Part
from robotd.children.message_framing import LONGEST, Unframer, header
from robotd.core.errors import ChildError, ProtocolError

_READ_BYTES = 2**18
"""At most, each time that the socket is ready: others have their turn between."""
_PIECES = 16
"""Given to the kernel at once."""
_WRITTEN_BYTES = 2**20
"""At most, each time that there is room: a reader that keeps up must not keep the loop."""


class SocketChannel:
    """One end, which owns its socket."""

    def __init__(self, end: socket.socket, *, room_bytes: int = ROOM_BYTES, longest: int = LONGEST) -> None:
        """Begin to receive.

        Args:
            end: a connected stream socket.
            room_bytes: what may wait to leave, and what may wait to be received before the other end has to wait.
            longest: a message from the other end that is longer ends the channel.
        """
        end.setblocking(False)
        self._socket: socket.socket | None = end
        self._loop = asyncio.get_running_loop()
        self._unframer = Unframer(longest)
        self._inbox = Inbox()
        self._outgoing = Outgoing(room_bytes)
        self._room_bytes = room_bytes
        self._left = asyncio.Event()
        self._is_reading = False
        self._is_writing = False
        self._read_on()

    def send(self, *parts: Part) -> bool:
        """Send one message; False if too much waits to leave already, or an end is gone."""
        length = sum(memoryview(part).nbytes for part in parts)
        if self._socket is None or not self._outgoing.put((header(length), *parts)):
            return False
        # Tried at once: most messages fit into the socket's buffer, and a turn of the loop later would be a
        # turn later for a stop.
        if not self._is_writing:
            self._write()
        return True

    async def receive(self) -> Message:
        """Wait for the next message; ChildError if an end is gone, or the other one sent what is no message."""
        message = await self._inbox.get()
        self._read_on()
        return message

    async def room(self) -> None:
        """Wait until less than half of what may wait to leave waits; ChildError if an end is gone."""
        while self._socket is not None and not self._outgoing.is_half_empty:
            self._left.clear()
            await self._left.wait()
        if self._socket is None:
            raise HungUp("the other end is gone")

    def close(self) -> None:
        """Give the channel up."""
        self._lose(HungUp("it was closed"))

    def _read_on(self) -> None:
        if self._socket is not None and not self._is_reading and self._inbox.bytes <= self._room_bytes:
            self._is_reading = True
            self._loop.add_reader(self._socket, self._read)

    def _read(self) -> None:
        if self._socket is None:
            return
        try:
            data = self._socket.recv(_READ_BYTES)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            self._lose(HungUp(f"the other end cannot be heard: {error.strerror}"))
            return
        if not data:
            self._lose(HungUp("the other end is gone"))
            return
        try:
            for message in self._unframer.feed(data):
                self._inbox.put(message)
        except ProtocolError as error:
            self._lose(ChildError(str(error)))
            return
        # No more is read until some was taken: the kernel's buffer fills, and the sender is told by its own
        # `send`.
        if self._inbox.bytes > self._room_bytes:
            self._is_reading = False
            self._loop.remove_reader(self._socket)

    def _write(self) -> None:
        if self._socket is None:
            return
        try:
            self._hand_over(self._socket)
        except (BlockingIOError, InterruptedError):
            pass
        except OSError:
            # What it sent before it went may still be read; the end of that tells of the loss.
            self._outgoing.drop(self._outgoing.bytes)
        if self._outgoing.is_half_empty:
            self._left.set()
        is_more = self._outgoing.bytes > 0
        if is_more and not self._is_writing:
            self._loop.add_writer(self._socket, self._write)
        elif not is_more and self._is_writing:
            self._loop.remove_writer(self._socket)
        self._is_writing = is_more

    def _hand_over(self, end: socket.socket) -> None:
        written = 0
        while self._outgoing.bytes and written < _WRITTEN_BYTES:
            # Several pieces a call: header and body are apart, and a call each would double the system calls.
            count = end.sendmsg(self._outgoing.pieces(_PIECES))
            self._outgoing.drop(count)
            written += count

    def _lose(self, reason: ChildError) -> None:
        self._inbox.lose(reason)
        self._left.set()
        # First forgotten, then closed: a callback that is due already finds no socket, not a number that is
        # somebody else's.
        end, self._socket = self._socket, None
        if end is not None:
            self._loop.remove_reader(end)
            self._loop.remove_writer(end)
            end.close()
