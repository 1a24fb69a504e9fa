"""A child that is a task of this process: the same program on the same channels, for tests and replays."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress

from robotd.children.channel import Channel
from robotd.children.memory_channel import memory_channel
from robotd.children.processor import Share
from robotd.core.errors import ChildError

Main = Callable[[Channel, Sequence[Channel]], Awaitable[None]]
"""The program of a child, on the channel by which it is watched and its lanes."""


class InProcess:
    """A child that runs on the loop of its parent."""

    def __init__(self, main: Main, lanes: int = 1) -> None:
        """Start ``main`` as a task of the running loop, with channels of memory in place of sockets."""
        (self.life, its_life), *pairs = (memory_channel() for _ in range(1 + lanes))
        self.lanes = [near for near, _ in pairs]
        self._ends = (self.life, *self.lanes)
        living = _lived(main, its_life, [far for _, far in pairs])
        self._task: asyncio.Task[None] = asyncio.create_task(living, name="a child")

    def share(self) -> Share:
        """Return what it has had of the processors: all that it wanted."""
        return Share()

    async def ended(self) -> str:
        """Wait until it has ended, and return how."""
        await asyncio.wait((self._task,))
        if self._task.cancelled():
            return "it was killed"
        error = self._task.exception()
        return "it ended" if error is None else f"it ended with {error!r}"

    def kill(self) -> None:
        """End it at once, as a signal does a process: by cancelling its task."""
        self._task.cancel()

    def close(self) -> None:
        """Hang up on it."""
        for channel in self._ends:
            channel.close()


async def _lived(main: Main, life: Channel, lanes: Sequence[Channel]) -> None:
    try:
        with suppress(ChildError):  # it was hung up on
            await main(life, lanes)
    finally:
        for channel in (life, *lanes):  # as the kernel closes what a process leaves open
            channel.close()
