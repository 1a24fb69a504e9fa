"""When a descriptor can be read or written: told by the event loop, or by a thread of its own.

The kernel takes what a serial port receives through a worker thread, and a program that asks a terminal whether there
is something to read waits for that worker, even in ``epoll_ctl``. The worker has no precedence: on a busy machine such
a wait was seen to take more than 0.2 s, and the event loop, which holds the leases and the stops, stood still for so
long. So nobody asks on the loop: a thread does, and what waits in the kernel by then is read without waiting.
"""

import asyncio
import contextlib
import os
import select
import threading
from collections.abc import Callable
from typing import Protocol

_WHATEVER_HAPPENED = select.POLLERR | select.POLLHUP | select.POLLNVAL


class Readiness(Protocol):
    """Tells when a descriptor is ready, once for each time it is asked; used on the loop only."""

    def when_readable(self, tell: Callable[[], None]) -> None:
        """Call ``tell`` on the loop when there is something to read, or nothing ever will be."""

    def when_writable(self, tell: Callable[[], None]) -> None:
        """Call ``tell`` on the loop when there is room to write, or never will be."""

    def forget_readable(self) -> None:
        """Nobody waits to read any more."""

    def forget_writable(self) -> None:
        """Nobody waits to write any more."""

    def close(self) -> None:
        """Watch no longer; before the descriptor is closed."""


class OnLoop:
    """The loop asks by itself: for what answers at once, as sockets do."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._loop = asyncio.get_running_loop()

    def when_readable(self, tell: Callable[[], None]) -> None:
        """See :class:`Readiness`."""
        self._loop.add_reader(self._descriptor, self._once, self.forget_readable, tell)

    def when_writable(self, tell: Callable[[], None]) -> None:
        """See :class:`Readiness`."""
        self._loop.add_writer(self._descriptor, self._once, self.forget_writable, tell)

    def forget_readable(self) -> None:
        """See :class:`Readiness`."""
        self._loop.remove_reader(self._descriptor)

    def forget_writable(self) -> None:
        """See :class:`Readiness`."""
        self._loop.remove_writer(self._descriptor)

    def close(self) -> None:
        """See :class:`Readiness`."""
        self.forget_readable()
        self.forget_writable()

    def _once(self, forget: Callable[[], None], tell: Callable[[], None]) -> None:
        # First, for what is told may wish again; and a level that stays ready would call in every turn of the loop.
        forget()
        tell()


class InThread:
    """A thread asks, and waits as long as it takes: for terminals."""

    def __init__(self, name: str, descriptor: int) -> None:
        """Begin to wait for wishes; ``name`` is for people.

        Raises:
            OSError: there is no descriptor left.
            RuntimeError: there is no thread left.
        """
        self._descriptor = descriptor
        self._loop = asyncio.get_running_loop()
        self._tells: dict[int, Callable[[], None]] = {}
        self._wanted = 0
        """What the thread shall ask for; nothing while it waits for the loop to hear its last word."""
        self._has_ended = False
        self._ending = threading.Lock()
        """The thread closes the bell, and not before it was rung for the last time."""
        self._bell = os.eventfd(0, os.EFD_CLOEXEC)
        try:
            # A daemon thread: it may hang in the kernel for as long as a driver likes, and the program ends without it.
            threading.Thread(target=self._watch, name=f"watch {name}", daemon=True).start()
        except RuntimeError:
            os.close(self._bell)
            raise

    def when_readable(self, tell: Callable[[], None]) -> None:
        """See :class:`Readiness`."""
        self._tells[select.POLLIN] = tell
        self._wish()

    def when_writable(self, tell: Callable[[], None]) -> None:
        """See :class:`Readiness`."""
        self._tells[select.POLLOUT] = tell
        self._wish()

    def forget_readable(self) -> None:
        """See :class:`Readiness`."""
        self._tells.pop(select.POLLIN, None)

    def forget_writable(self) -> None:
        """See :class:`Readiness`."""
        self._tells.pop(select.POLLOUT, None)

    def close(self) -> None:
        """See :class:`Readiness`; the thread ends by itself, soon."""
        self._tells.clear()
        with self._ending:
            if not self._has_ended:
                self._has_ended = True
                os.eventfd_write(self._bell, 1)

    def _wish(self) -> None:
        wanted = sum(self._tells)
        # What is forgotten meanwhile is not taken back: the thread finds it ready once, and nobody is told.
        if wanted & ~self._wanted and not self._has_ended:
            self._wanted = wanted
            os.eventfd_write(self._bell, 1)

    def _heard(self, happened: int) -> None:
        self._wanted = 0
        # A list, for those who are told wish again.
        for event in [one for one in self._tells if happened & (one | _WHATEVER_HAPPENED)]:
            self._tells.pop(event)()
        if self._tells:
            self._wish()

    # In the thread

    def _watch(self) -> None:
        poll = select.poll()
        poll.register(self._bell, select.POLLIN)
        while True:
            happened = dict(poll.poll())
            if self._bell in happened:
                os.eventfd_read(self._bell)
                with self._ending:
                    if self._has_ended:
                        break
                poll.register(self._descriptor, self._wanted)
            elif self._descriptor in happened:
                # Until the next wish: what stays ready would turn this thread round and round.
                poll.unregister(self._descriptor)
                with contextlib.suppress(RuntimeError):  # the loop is closed: nobody waits any more
                    self._loop.call_soon_threadsafe(self._heard, happened[self._descriptor])
        os.close(self._bell)
