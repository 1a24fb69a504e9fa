"""One publisher, many readers, none of which can hold the others up."""

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from typing import Generic, TypeVar

T = TypeVar("T")


class Subscription(Generic[T]):
    """One reader's bounded queue; when it is full the oldest item gives way."""

    def __init__(self, depth: int) -> None:
        # The oldest gives way: a slow reader still learns the newest.
        self._items: deque[T] = deque(maxlen=depth)
        self._ready = asyncio.Event()

    def offer(self, item: T) -> None:
        """Queue an item, at the cost of the oldest where the queue is full; never waits."""
        self._items.append(item)
        self._ready.set()

    async def get(self) -> T:
        """Wait for the next item, in order."""
        # Asked again after each waking: another task of the same reader may have taken it.
        while not self._items:
            self._ready.clear()
            await self._ready.wait()
        return self._items.popleft()

    async def __aiter__(self) -> AsyncIterator[T]:
        """Yield items for ever."""
        while True:
            yield await self.get()


class Broadcast(Generic[T]):
    """Hands every published item to every subscription open at that moment, and keeps the latest."""

    def __init__(self) -> None:
        self._subscriptions: list[Subscription[T]] = []
        self.latest: T | None = None

    def publish(self, item: T) -> None:
        """Hand an item out."""
        # Before it is handed out: who is woken by it and looks for the latest must find this one.
        self.latest = item
        for subscription in self._subscriptions:
            subscription.offer(item)

    def forget(self) -> None:
        """Have no latest any more: it is known no longer whether it holds."""
        self.latest = None

    @contextmanager
    def subscribe(self, depth: int = 256) -> Iterator[Subscription[T]]:
        """Open a subscription for the length of a ``with`` block."""
        subscription: Subscription[T] = Subscription(depth)
        self._subscriptions.append(subscription)
        try:
            yield subscription
        finally:
            self._subscriptions.remove(subscription)
