"""One socket that publishes: numbers what goes out, and tells who joins late what was said last."""

import asyncio
from collections.abc import Callable

from robotd.contract.topics import EVENTS, Published, Topic, encode_frame, to_wire
from robotd.core.counted import Counted
from robotd.server.client_connection import Connection
from robotd.server.zmtp import Violation, message

_JOIN, _LEAVE = b"\x01", b"\x00"
"""How a subscription begins, and the end of one."""
MOST_SUBSCRIPTIONS = 64
"""Of one client, far more than there are topics."""
GREETED_AFTER_S = 0.01
"""Who subscribes to several topics is greeted when it has."""


class Outlet:
    """Publishes single frames to those who subscribed, as far as they take them."""

    def __init__(self, session: str, counted: Counted, asked_for: Callable[[Topic], None] | None = None) -> None:
        """Publish in this session.

        Args:
            session: goes with every message.
            counted: where messages are counted that somebody missed.
            asked_for: told of each topic that somebody joins, in place of telling that one what was said last.
        """
        self._session = session
        self._counted = counted
        self._asked_for = asked_for
        self._loop = asyncio.get_running_loop()
        self._seq: dict[Topic, int] = {}
        self._last: dict[str, tuple[Topic, int, bytes]] = {}
        """By the name of each event what was said last: its topic, its number there, and the message."""
        self._readers: dict[Connection, set[bytes]] = {}
        """What each is subscribed to, as prefixes."""
        self._new: dict[Connection, set[Topic]] = {}

    def send(self, event: Published) -> None:
        """Publish; a reader that is too slow misses it and sees the gap."""
        topic, name = EVENTS[type(event)]
        fields = to_wire(event)[1]  # before it is numbered: what has no form is no message missed
        seq = self._number(topic)
        data = self._send(topic, encode_frame(topic, self._session, seq, fields))
        self._last[name] = topic, seq, data

    async def send_large(self, event: Published) -> None:
        """Publish what takes long to encode; one call at a time, or the numbers may come out of order.

        It is not kept: who joins is told it again.
        """
        topic, _ = EVENTS[type(event)]
        self._send(topic, await asyncio.to_thread(_frame_of, event, self._session, self._number(topic)))

    def is_read(self, topic: Topic) -> bool:
        """Return whether anybody is subscribed to a topic."""
        return any(topic.prefix.startswith(prefix) for prefixes in self._readers.values() for prefix in prefixes)

    def joined(self, connection: Connection) -> None:
        """Let a client subscribe."""
        self._readers[connection] = set()

    def left(self, connection: Connection) -> None:
        """Forget a client."""
        self._readers.pop(connection, None)
        self._new.pop(connection, None)

    def heard(self, connection: Connection, frames: tuple[bytes, ...]) -> None:
        """Take a subscription or the end of one; a Violation refuses what is neither, or too many."""
        (said,) = frames
        begin, prefix = said[:1], said[1:]
        prefixes = self._readers[connection]
        if begin == _LEAVE:
            prefixes.discard(prefix)
        elif begin == _JOIN:
            prefixes.add(prefix)
            if len(prefixes) > MOST_SUBSCRIPTIONS:
                raise Violation(f"more than {MOST_SUBSCRIPTIONS} subscriptions")
            self._welcome(connection, {topic for topic in Topic if topic.prefix.startswith(prefix)})
        else:
            raise Violation(f"{said[:20]!r}, which is no subscription")

    def overheard(self, connection: Connection, frames: tuple[bytes, ...]) -> None:
        """Leave it: what subscribes to too much says nothing that matters."""

    def _welcome(self, connection: Connection, topics: set[Topic]) -> None:
        # One call for all who come within the moment: a program that subscribes to ten topics is greeted once.
        if not self._new:
            self._loop.call_later(GREETED_AFTER_S, self._greet)
        self._new.setdefault(connection, set()).update(topics)

    def _greet(self) -> None:
        """Tell every new subscriber the last message of each event, the latest of each topic first.

        So a reader that goes by numbers alone takes the older ones for seen, and misses none. The status comes last:
        when it arrives, every subscription made before it is in force.
        """
        new, self._new = self._new, {}
        if self._asked_for is not None:
            for topic in set().union(*new.values()):
                self._asked_for(topic)
            return
        latest_first = sorted(self._last.values(), key=lambda kept: (kept[0] is Topic.STATUS, -kept[1]))
        for connection, topics in new.items():
            for topic, _, data in latest_first:
                if topic in topics:
                    connection.send(data)

    def _number(self, topic: Topic) -> int:
        seq = self._seq.get(topic, 0)
        # Counted before it is known whether it can be sent: what is lost must show as a gap.
        self._seq[topic] = seq + 1
        return seq

    def _send(self, topic: Topic, frame: bytes) -> bytes:
        data = message(frame)  # made once: what waits for many readers is one and the same
        # A copy: who cannot be sent to may be cut off meanwhile, and leaves the table.
        for connection, prefixes in tuple(self._readers.items()):
            if any(frame.startswith(prefix) for prefix in prefixes) and not connection.send(data):
                self._counted.count("dropped_messages_total", topic=topic)
        return data


def _frame_of(event: Published, session: str, seq: int) -> bytes:
    topic, fields = to_wire(event)
    return encode_frame(topic, session, seq, fields)
