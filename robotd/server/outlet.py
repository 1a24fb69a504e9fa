"""One XPUB socket: numbers what goes out, and tells who joins late what was said last."""

import asyncio
import contextlib
import logging
from typing import NoReturn

import zmq
import zmq.asyncio

from robotd.contract.topics import EVENTS, Published, Topic, encode_frame, to_wire
from robotd.core.log_limit import LogLimit

_JOIN = b"\x01"
"""How a subscription begins on an XPUB socket; a zero ends one."""
BETWEEN_GREETINGS_S = 0.02
"""A greeting reaches all readers, so those who join within this are greeted together."""
_MOST_JOINS = 1000
"""At a time: who subscribes without end must not keep the loop."""
_AFTER_ERROR_S = 0.1
"""A socket that fails again and again must not keep the loop busy."""

log = logging.getLogger(__name__)


class Outlet:
    """Publishes single frames and hears who subscribes; no message that goes wrong ends the daemon."""

    def __init__(self, socket: zmq.asyncio.Socket, session: str) -> None:
        self._socket = socket
        self._session = session
        self._seq: dict[Topic, int] = {}
        self._last: dict[Topic, bytes] = {}
        self._complaints = LogLimit()

    async def send(self, topic: Topic, fields: dict[str, object]) -> None:
        """Publish; a reader that is too slow misses it and sees the gap. Never waits."""
        await self._send(topic, encode_frame(topic, self._session, self._number(topic), fields))

    async def send_large(self, event: Published) -> None:
        """Publish what takes long to encode; one call at a time, or the numbers may come out of order."""
        topic, _ = EVENTS[type(event)]
        await self._send(topic, await asyncio.to_thread(_frame_of, event, self._session, self._number(topic)))

    def _number(self, topic: Topic) -> int:
        seq = self._seq.get(topic, 0)
        # Counted before it is known whether it can be sent: what is lost must show as a gap.
        self._seq[topic] = seq + 1
        return seq

    async def _send(self, topic: Topic, frame: bytes) -> None:
        self._last[topic] = frame
        await self._put(frame)

    async def greet(self) -> NoReturn:
        """Tell every new subscriber the last message of each topic, until cancelled.

        XPUB cannot answer one subscriber alone: a repeat reaches all. So repeats are kept rare, and readers ignore
        a number they have seen. The status comes last: when it arrives, every subscription made before it is in force.
        """
        while True:
            for topic in sorted(await self.joined(), key=lambda topic: topic is Topic.STATUS):
                if topic in self._last:
                    await self._put(self._last[topic])
            await asyncio.sleep(BETWEEN_GREETINGS_S)

    async def joined(self) -> set[Topic]:
        """Wait until somebody subscribes, and return to which topics."""
        topics: set[Topic] = set()
        while not topics:
            try:
                topics |= _topics_of(await self._socket.recv())
            except Exception as error:
                self._complain("a subscription could not be received", error)
                await asyncio.sleep(_AFTER_ERROR_S)
        with contextlib.suppress(Exception):  # none waits, or the next wait will tell
            for _ in range(_MOST_JOINS):
                topics |= _topics_of(await self._socket.recv(zmq.NOBLOCK))
        return topics

    async def _put(self, frame: bytes) -> None:
        try:
            await self._socket.send(frame)
        except Exception as error:  # its readers see the gap
            self._complain("a message could not be published", error)

    def _complain(self, what: str, error: Exception) -> None:
        if self._socket.closed:
            raise error
        said = error.strerror if isinstance(error, zmq.ZMQError) else repr(error)
        if line := self._complaints.line(f"{what}: {said}"):
            log.warning("%s", line)


def _frame_of(event: Published, session: str, seq: int) -> bytes:
    topic, fields = to_wire(event)
    return encode_frame(topic, session, seq, fields)


def _topics_of(message: bytes) -> set[Topic]:
    """Return the topics a subscription begins to match; none if it is something else."""
    if not message.startswith(_JOIN):
        return set()
    return {topic for topic in Topic if topic.prefix.startswith(message[1:])}
