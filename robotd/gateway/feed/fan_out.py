"""One subscription for all browsers: what comes is kept, and laid into every outbox."""

import asyncio
import contextlib
import logging
from collections.abc import AsyncGenerator, Awaitable, Callable
from typing import Protocol

from robotd.client import Gap
from robotd.contract.events import MapChanged
from robotd.contract.topics import Frame
from robotd.core.clock import now_ns
from robotd.core.errors import RemoteProtocolError, RobotdError
from robotd.gateway.feed.heard_frames import HeardFrame
from robotd.gateway.feed.map_kept import as_heard, folded
from robotd.gateway.feed.snapshot import Snapshot

_AGAIN_S = 1.0

log = logging.getLogger(__name__)


class Listener(Protocol):
    """Anyone who is told: a browser's connection, for one."""

    def hear(self, heard: HeardFrame) -> None:
        """Take a message; it must not wait."""

    def lost(self, topic: str, count: int) -> None:
        """Take that messages of a topic did not come."""


class FanOut:
    """Hands on what the daemon says."""

    def __init__(self, snapshot: Snapshot, ask_map: Callable[[], Awaitable[MapChanged]]) -> None:
        self.snapshot = snapshot
        self._ask_map = ask_map
        self._listeners: set[Listener] = set()
        self._map_work = asyncio.Event()
        self._see_rank: set[Listener] = set()
        self._rank_wanted = asyncio.Event()
        self.frames = 0
        """Messages handed on since the start."""

    def join(self, listener: Listener) -> list[bytes]:
        """Tell somebody all that comes from now on, and return what came before."""
        self._listeners.add(listener)
        return list(self.snapshot.frames())

    def leave(self, listener: Listener) -> None:
        """Tell somebody nothing any more."""
        self._listeners.discard(listener)
        self.show_rank(listener, show=False)

    @property
    def wants_rank(self) -> bool:
        """Whether anybody looks at the heat map."""
        return bool(self._see_rank)

    def show_rank(self, listener: Listener, *, show: bool) -> None:
        """Tell somebody of the heat map, or no more: the daemon makes it only while somebody looks."""
        (self._see_rank.add if show else self._see_rank.discard)(listener)
        if self.wants_rank:
            self._rank_wanted.set()
        else:
            self._rank_wanted.clear()

    async def follow(self, subscribe: Callable[[], AsyncGenerator[Frame | Gap, None]]) -> None:
        """Hand on frames as they come, for ever: a duty."""
        while True:
            try:
                async with contextlib.aclosing(subscribe()) as frames:
                    async for item in frames:
                        self._take(item)
            except RemoteProtocolError as error:
                # Of another version, or damaged: the page shows that nothing is heard, which is true.
                log.warning("what the daemon says cannot be read: %s", error)
                await asyncio.sleep(_AGAIN_S)

    async def follow_rank(self, subscribe: Callable[[], AsyncGenerator[Frame | Gap, None]]) -> None:
        """Hand on heat maps while somebody looks at them: a duty."""
        while True:
            await self._rank_wanted.wait()
            try:
                async with contextlib.aclosing(subscribe()) as frames:
                    await self._hand_rank_on(frames)
            except RemoteProtocolError as error:
                log.warning("a heat map cannot be read: %s", error)
                await asyncio.sleep(_AGAIN_S)

    async def _hand_rank_on(self, frames: AsyncGenerator[Frame | Gap, None]) -> None:
        async for item in frames:
            # The subscription ends with the last who looks, and with it the daemon's work.
            if not self._see_rank:
                return
            if isinstance(item, Frame):
                heard = HeardFrame.read(item)
                for listener in tuple(self._see_rank):
                    listener.hear(heard)

    def _take(self, item: Frame | Gap) -> None:
        if isinstance(item, Gap):
            self._tell_lost(item)
            return
        try:
            self.accept(HeardFrame.read(item))
        except (RobotdError, ValueError, KeyError, TypeError) as error:
            # One message of a newer daemon must not end what all pages live by.
            log.warning("a message of the daemon was left out: %s", error)

    def accept(self, heard: HeardFrame) -> None:
        """Take a message.

        Raises:
            RobotdError, ValueError, KeyError, TypeError: it is not what its name promises.
        """
        self.snapshot.accept(heard, now_ns())
        self.frames += 1
        for listener in tuple(self._listeners):
            listener.hear(heard)
        if self.snapshot.map_gap or self.snapshot.map.is_long:
            self._map_work.set()

    async def keep_map(self) -> None:
        """Ask for the whole map after a gap, and fold its changes into it when they are many: a duty."""
        while True:
            await self._map_work.wait()
            # Before it is looked at: what comes during the work sets it again.
            self._map_work.clear()
            if self.snapshot.map_gap:
                await self._ask_whole()
            elif self.snapshot.map.is_long:
                await self._fold()

    async def _ask_whole(self) -> None:
        session = self.snapshot.session
        try:
            change = await self._ask_map()
        except RobotdError as error:
            log.info("the whole map could not be had: %s", error)
            await asyncio.sleep(_AGAIN_S)
            self._map_work.set()
            return
        whole = await asyncio.to_thread(as_heard, change, session or "", 0)
        # A daemon that was started meanwhile has another map: the answer of the last one is not laid over it.
        if self.snapshot.session == session:
            self.snapshot.accept(whole, now_ns())
            for listener in tuple(self._listeners):
                listener.hear(whole)

    async def _fold(self) -> None:
        parts = self.snapshot.map.parts()
        if parts is not None:
            with contextlib.suppress(RobotdError, ValueError):
                self.snapshot.map.replace(await asyncio.to_thread(folded, *parts))

    def _tell_lost(self, gap: Gap) -> None:
        if gap.missed is not None:
            for listener in tuple(self._listeners):
                listener.lost(gap.topic, gap.missed)
