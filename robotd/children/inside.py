"""The child's side: what it was given at its birth, and how it shows that it lives."""

import ctypes
import logging
import os
import resource
import signal
import socket
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from robotd.children.channel import Channel
from robotd.children.confinement import confine_to_program
from robotd.children.pings import READY
from robotd.children.socket_channel import SocketChannel
from robotd.core.errors import ChildError
from robotd.core.precedence import no_realtime

_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True, slots=True)
class Birth:
    """What a child was given."""

    descriptors: tuple[int, ...]
    """Of the channel by which it is watched, and of its lanes."""
    arguments: tuple[str, ...]
    """Of its own."""
    unconfined: str
    """Why the kernel does not keep it from other files than its program's; empty if it does."""

    def channels(self) -> tuple[Channel, list[Channel]]:
        """Return the channel by which it is watched, and the lanes; on the running loop, once."""
        life, *lanes = (SocketChannel(socket.socket(fileno=number)) for number in self.descriptors)
        return life, list(lanes)

    def tell(self, log: logging.Logger) -> None:
        """Say in the log what does not keep it from the files of others."""
        if self.unconfined:
            log.warning("not confined to its own files, for the kernel has no Landlock for it: %s", self.unconfined)


def adopted(argv: Sequence[str]) -> Birth:
    """Bind the life of this process to its parent's, and what it may have and reach to its bounds.

    It is the first thing that a child does, before it imports what it computes by: libraries begin threads.

    Args:
        argv: as :func:`robotd.children.process.spawn` makes it, without the program's name.
    """
    parent, memory_bytes, sockets_in, descriptors, *arguments = argv
    die_with_parent()  # beside the end of the channel, which a child that computes would find out late
    # The kernel signals a death only to those that asked before it.
    if os.getppid() != int(parent):  # it went before we had asked for that
        raise SystemExit(0)
    no_realtime()
    # Only the parent decides when to end: of a terminal's Ctrl-C it hears as well, and stops the robot first.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    # Address space and not resident memory: the kernel refuses the one at the allocation, where Python can
    # raise an error.
    if int(memory_bytes):
        with suppress(OSError, ValueError):  # where that is forbidden it is for the service manager
            resource.setrlimit(resource.RLIMIT_AS, (int(memory_bytes), int(memory_bytes)))
    with suppress(OSError):  # where memory is short, the kernel shall take a child before the one that stops the robot
        Path("/proc/self/oom_score_adj").write_text("500", encoding="ascii")
    # Last: everything above still needs what it takes away.
    unconfined = confine_to_program(sockets_in)
    return Birth(tuple(int(number) for number in descriptors.split(",")), tuple(arguments), unconfined)


def die_with_parent() -> None:
    """Have the kernel end this process when its parent has ended, by whatever cause."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


async def live(life: Channel, version: str) -> None:
    """Say that this child is ready, and answer each ping, until the parent hangs up.

    It runs on the loop that does the child's work: a loop that is stuck answers nothing, and the child is killed.
    """
    life.send(READY, version.encode())
    with suppress(ChildError):
        while True:
            # Given back as it came: a child need not know what a ping is, and cannot answer one that was not
            # sent.
            life.send(await life.receive())
