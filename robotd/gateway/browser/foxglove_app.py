"""Foxglove's app at a socket of its own: told what the robot tells, in the app's own messages. It is asked nothing."""

import asyncio
from typing import Any

from robotd.contract.topics import Frame
from robotd.core.clock import NS_PER_S, now_ns, wall_offset_ns
from robotd.core.errors import ServerError
from robotd.gateway.access.visitor_limits import Rate
from robotd.gateway.browser import foxglove_protocol as protocol
from robotd.gateway.browser.console_protocol import TEXTS_PER_S
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.browser.services import Services
from robotd.gateway.feed.foxglove_channels import FoxgloveChannel, FoxgloveChannels, advertised
from robotd.gateway.feed.heard_frames import HeardFrame
from robotd.gateway.feed.page_outbox import Full, PageOutbox


class FoxgloveApp:
    """One app."""

    def __init__(self, person: Person, services: Services) -> None:
        self.person = person
        self.outbox = PageOutbox(lambda: services.fan.snapshot.map.frames)
        self.woken = asyncio.Event()
        """Set when something waits in the outbox."""
        self.ended: str | None = None
        """Why this connection has to end; None while it need not."""
        self._channels = FoxgloveChannels(wall_offset_ns())
        self._said: set[int] = set()
        self._subscriptions = protocol.Subscriptions()
        self._rate = Rate(TEXTS_PER_S, now_ns() / NS_PER_S)
        self._wanted: list[int] = []
        """Channels that were subscribed to just now, and of which the latest has not been sent."""

    def greet(self, robot: str, session: str, frames: list[bytes]) -> None:
        """Let who tells, and what is known, wait to be sent."""
        self.outbox.say(protocol.server_info(robot, session))
        self.outbox.greet(frames)
        self.woken.set()

    def hear(self, heard: HeardFrame) -> None:
        """Let a message of the daemon wait to be sent."""
        self._wait_with(lambda: self.outbox.put(heard))

    def lost(self, topic: str, count: int) -> None:
        """Miss what the next message of its kind tells as well."""

    def take(self, text: str) -> None:
        """Take what the app says; must not wait.

        Raises:
            ServerError: it says too much; the connection ends.
        """
        if not self._rate.take(now_ns() / NS_PER_S):
            raise ServerError("too_many", f"more than {TEXTS_PER_S:g} messages a second")
        try:
            self._wanted += self._subscriptions.take(text)
            self.woken.set()
        except ServerError as error:
            problem = protocol.problem(error.message)
            self._wait_with(lambda: self.outbox.say(problem))

    async def messages(self, frame: Frame) -> list[str | bytes]:
        """Return what the app is told of a frame: new channels, and what it wants of them."""
        # On a thread: a map becomes megabytes of JSON, and a stop must not wait for that.
        told = await asyncio.to_thread(self._channels.take, frame)
        new = [channel for channel in told if channel.id not in self._said]
        self._said.update(channel.id for channel in new)
        said: list[str | bytes] = [protocol.advertise(advertised(new))] if new else []
        return [*said, *self._latest(told)]

    def caught_up(self) -> list[bytes]:
        """Return the latest of what was subscribed to just now: a map may not change for hours."""
        wanted, self._wanted = self._wanted, []
        return self._latest([one for one in self._channels.channels.values() if one.id in wanted])

    def finish(self, why: str) -> None:
        """Let the connection end as soon as it can."""
        self.ended = self.ended or why
        self.woken.set()

    def _latest(self, channels: list[FoxgloveChannel]) -> list[bytes]:
        unix_ns = now_ns() + wall_offset_ns()
        return [
            protocol.message(number, unix_ns, self._channels.latest[channel.id])
            for channel in channels
            for number in self._subscriptions.of(channel.id)
        ]

    def _wait_with(self, put: Any) -> None:
        try:
            put()
        except Full:
            self.finish("it reads too slowly")
        self.woken.set()
