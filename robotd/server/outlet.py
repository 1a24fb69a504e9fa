"""One XPUB socket: numbers what goes out, and tells who joins late what was said last."""

import asyncio
import contextlib
from typing import NoReturn

import zmq
import zmq.asyncio

from robotd.server.topics import EVENTS, Published, Topic, encode_frame, to_wire

_JOIN = b"\x01"
BETWEEN_GREETINGS_S = 0.02
_MOST_JOINS = 1000


class Outlet:
    """Publishes single frames and hears who subscribes."""

    def __init__(self, socket: zmq.asyncio.Socket, session: str) -> None:
        self._socket = socket
        self._session = session
        self._seq: dict[Topic, int] = {}
        self._last: dict[Topic, bytes] = {}

    async def send(self, topic: Topic, fields: dict[str, object]) -> None:
        """Publish; a reader that is too slow misses it and sees the gap. Never waits."""
        await self._send(topic, encode_frame(topic, self._session, self._number(topic), fields))

    async def send_large(self, event: Published) -> None:
        """Publish what takes long to encode; one call at a time, or the numbers may come out of order."""
        topic, _ = EVENTS[type(event)]
        await self._send(topic, await asyncio.to_thread(_frame_of, event, self._session, self._number(topic)))

    def _number(self, topic: Topic) -> int:
        seq = self._seq.get(topic, 0)
        self._seq[topic] = seq + 1
        return seq

    async def _send(self, topic: Topic, frame: bytes) -> None:
        self._last[topic] = frame
        await self._socket.send(frame)

    async def greet(self) -> NoReturn:
        """Tell whoever subscribes the last message of each topic, until cancelled.

        XPUB cannot answer one subscriber alone: a repeat reaches all. So repeats are kept rare, and readers ignore
        a number they have seen. The status comes last: when it arrives, every subscription made before it is in force.
        """
        while True:
            for topic in sorted(await self.joined(), key=lambda topic: topic is Topic.STATUS):
                if topic in self._last:
                    await self._socket.send(self._last[topic])
            await asyncio.sleep(BETWEEN_GREETINGS_S)

    async def joined(self) -> set[Topic]:
        """Wait until somebody subscribes, and return to which topics."""
        topics: set[Topic] = set()
        while not topics:
            topics |= _topics_of(await self._socket.recv())
        with contextlib.suppress(zmq.Again):
            for _ in range(_MOST_JOINS):
                topics |= _topics_of(await self._socket.recv(zmq.NOBLOCK))
        return topics


def _frame_of(event: Published, session: str, seq: int) -> bytes:
    topic, fields = to_wire(event)
    return encode_frame(topic, session, seq, fields)


def _topics_of(message: bytes) -> set[Topic]:
    """Return the topics a subscription begins to match; none if it is something else."""
    if not message.startswith(_JOIN):
        return set()
    return {topic for topic in Topic if topic.prefix.startswith(message[1:])}
