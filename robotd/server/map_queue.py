"""What happens to the map, on its way out; when changes come too fast, one whole map takes the place of them all."""

import asyncio
from collections import deque

from robotd.contract.events import MapChanged
from robotd.contract.topics import Published

_DEPTH = 64
"""Changes; a reader that needs more is served sooner by the whole map. As many other events: a stop has four."""


class MapQueue:
    """Events in order, or the wish for a whole map."""

    def __init__(self) -> None:
        self._events: deque[Published] = deque()
        self._wants_whole = False
        self._ready = asyncio.Event()

    def put(self, event: Published) -> None:
        """Queue an event; a whole map, or too many changes, make all changes that wait superfluous."""
        if isinstance(event, MapChanged) and event.whole:
            self._drop_changes()
        # Changes and other events each have their depth: a map that changes fast must not push out what became
        # of a stop.
        alike = [
            waiting for waiting in self._events if isinstance(waiting, MapChanged) == isinstance(event, MapChanged)
        ]
        if len(alike) == _DEPTH:
            if isinstance(event, MapChanged):
                self.ask_for_whole()
                return
            self._events.remove(alike[0])
        self._events.append(event)
        self._ready.set()

    def ask_for_whole(self) -> None:
        """Queue the whole map as it will be when its turn comes: it holds every change that waits now."""
        self._drop_changes()
        self._wants_whole = True
        self._ready.set()

    async def get(self) -> Published | None:
        """Wait for the next event; None asks for the whole map, to be taken now."""
        while not (self._wants_whole or self._events):
            self._ready.clear()
            await self._ready.wait()
        if self._wants_whole:
            self._wants_whole = False
            self._drop_changes()  # they are in the map that is taken now
            return None
        return self._events.popleft()

    def _drop_changes(self) -> None:
        self._events = deque(event for event in self._events if not isinstance(event, MapChanged))
