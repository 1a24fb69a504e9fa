"""Changes of the map on their way out; when they come too fast, one whole map takes the place of them all."""

import asyncio
from collections import deque

from robotd.contract.events import MapChanged

_DEPTH = 64
"""Changes; a reader that needs more is served sooner by the whole map."""


class MapQueue:
    """Changes in order, or the wish for a whole map."""

    def __init__(self) -> None:
        self._changes: deque[MapChanged] = deque()
        self._wants_whole = False
        self._ready = asyncio.Event()

    def put(self, change: MapChanged) -> None:
        """Queue a change; a whole map, or too many changes, make all that wait superfluous."""
        if change.whole:
            self._changes.clear()
        if len(self._changes) == _DEPTH:
            self.ask_for_whole()
            return
        self._changes.append(change)
        self._ready.set()

    def ask_for_whole(self) -> None:
        """Queue the whole map as it will be when its turn comes: it holds every change that waits now."""
        self._changes.clear()
        self._wants_whole = True
        self._ready.set()

    async def get(self) -> MapChanged | None:
        """Wait for the next change; None asks for the whole map, to be taken now."""
        while not (self._wants_whole or self._changes):
            self._ready.clear()
            await self._ready.wait()
        if self._wants_whole:
            self._wants_whole = False
            self._changes.clear()  # they are in the map that is taken now
            return None
        return self._changes.popleft()
