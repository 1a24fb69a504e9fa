"""The far end of a pseudo-terminal: where an emulated board sits, as if behind a serial port."""

import asyncio
import os
import pty
import select
import tty

from robotd.hardware.transport.descriptor import DescriptorTransport, wake
from robotd.hardware.transport.descriptor_readiness import InThread

_LOOK_AGAIN_S = 0.02


class PtyEnd(DescriptorTransport):
    """The master side; programs open ``path``, one after the other, as often as they like.

    While nobody has ``path`` open, nothing arrives and what is written is gone, as with a cable that
    leads nowhere. The kernel cannot tell us when somebody opens it, and calls a line that nobody has
    open readable all the time, so a pending read looks again every 20 ms instead of watching it.
    """

    def __init__(self, path: str, master: int) -> None:
        """Take over a non-blocking master descriptor, and close it in the end."""
        super().__init__(path, master, InThread(path, master), lambda: os.close(master))
        self._poll = select.poll()
        self._poll.register(master, 0)  # hanging up is reported whether asked for or not

    @property
    def path(self) -> str:
        """What to open at the other side."""
        return self._name

    @property
    def is_plugged(self) -> bool:
        """Whether somebody has ``path`` open."""
        return self._lost is None and not self._poll.poll(0)

    def _watch(self, readable: "asyncio.Future[None]") -> None:
        if self.is_plugged:
            super()._watch(readable)
        else:
            self._loop.call_later(_LOOK_AGAIN_S, wake, readable)

    def _hang_up(self, reason: str) -> None:
        # Only who had it open is gone: the next one opens the same path.
        self._drop_output()

    def _flush(self) -> None:
        if self.is_plugged:
            super()._flush()
        else:
            self._drop_output()

    def _drop_output(self) -> None:
        self._outbox.clear()
        self._readiness.forget_writable()


def open_pty() -> PtyEnd:
    """Make a new pseudo-terminal in raw mode and return its far end; must run on the event loop."""
    master, slave = pty.openpty()
    tty.setraw(slave)  # before anybody opens it: a kernel that echoes would answer for the board
    path = os.ttyname(slave)
    os.close(slave)  # kept open it would look plugged in for ever
    os.set_blocking(master, False)
    return PtyEnd(path, master)
