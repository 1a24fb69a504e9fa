"""A child as a process: started by exec, with one end of each lane in its hands, and ended for certain."""

import asyncio
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Protocol

from robotd.children.channel import Channel
from robotd.children.processor import Share, share_of
from robotd.children.socket_channel import SocketChannel
from robotd.core.errors import ChildError


@dataclass(frozen=True, slots=True)
class Program:
    """A program to start as a child, and what it is given and allowed."""

    runs: tuple[str, ...]
    """What Python shall run, ``("-m", "robotd.front")``; it begins with :func:`robotd.children.inside.adopted`."""
    lanes: int = 1
    """How many channels it has, beside the one by which it is watched."""
    arguments: tuple[str, ...] = ()
    memory_bytes: int = 0
    """Bound of its address space; 0 is none."""
    sockets_in: str = ""
    """Directory in which it makes and removes sockets; of all else it may read its program, and no more."""
    inherits: tuple[int, ...] = ()
    """Descriptors that it finds open under the same numbers."""


class Running(Protocol):
    """A child that was started."""

    @property
    def life(self) -> Channel:
        """Where it says that it is ready, and answers to pings."""

    @property
    def lanes(self) -> Sequence[Channel]:
        """The channels for its work, in the order in which it knows them."""

    def share(self) -> Share:
        """Return what it has had of the processors."""

    async def ended(self) -> str:
        """Wait until it has ended, by whatever cause, and return that in words."""

    def kill(self) -> None:
        """End it at once, whatever it does."""

    def close(self) -> None:
        """Hang up on it, which it takes as the wish to end; by and by it does, or is killed."""


class Process:
    """A child that is a process of the operating system; reaped on the loop, whatever ends it."""

    def __init__(self, process: "subprocess.Popen[bytes]", ends: Sequence[socket.socket]) -> None:
        """Take over a process that was started, and our ends of its sockets."""
        self._process = process
        self.life, *self.lanes = (SocketChannel(end) for end in ends)
        self._ended: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        # A descriptor and not SIGCHLD: it is of this child alone, is known on the loop at once, and needs no
        # handler of the program's.
        self._watch = os.pidfd_open(process.pid)
        asyncio.get_running_loop().add_reader(self._watch, self._reap)

    @property
    def pid(self) -> int:
        """Its number with the operating system; another process may have it once this one was reaped."""
        return self._process.pid

    def share(self) -> Share:
        """Return what it has had of the processors."""
        return share_of(self._process.pid)

    async def ended(self) -> str:
        """Wait until it has ended, and return how."""
        # Several wait for one end; one of them that is cancelled must not take it from the others.
        return await asyncio.shield(self._ended)

    def kill(self) -> None:
        """End it at once: stopped, stuck or computing."""
        # A number that was reaped may be somebody else's process by now.
        if self._process.returncode is None:
            self._process.kill()

    def close(self) -> None:
        """Hang up on it."""
        for channel in (self.life, *self.lanes):
            channel.close()

    def _reap(self) -> None:
        asyncio.get_running_loop().remove_reader(self._watch)
        os.close(self._watch)
        code = self._process.wait()  # it is a zombie: nothing is waited for
        self._ended.set_result(_in_words(code))


def spawn(program: Program) -> Process:
    """Start a child.

    By exec, never by a fork alone: the threads of this process hold locks that nobody would ever give back in a copy
    of it.

    Raises:
        ChildError: it cannot be started: no memory, no descriptor, no process more.
    """
    try:
        return _spawn(program)
    except (OSError, MemoryError, subprocess.SubprocessError) as error:
        raise ChildError(f"it cannot be started: {str(error) or 'no memory'}") from error


def _spawn(program: Program) -> Process:
    with ExitStack() as theirs, ExitStack() as ours:
        near_ends, inherited = [], []
        for _ in range(1 + program.lanes):
            near, far = socket.socketpair()
            near_ends.append(ours.enter_context(near))
            inherited.append(theirs.enter_context(far).fileno())
        # Safe path: what lies in the working directory must not be imported in place of what is installed.
        command = [sys.executable, "-P", *program.runs, str(os.getpid()), str(program.memory_bytes)]
        command += [program.sockets_in, ",".join(map(str, inherited)), *program.arguments]
        # No pipes: what it says goes over its lanes, and its log to where ours goes. A session of its own: most
        # kernels share processors among sessions first, and in one with a child that strangers keep busy the process
        # that owns the lines would have its turn when that child's share is due (decision 70).
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, pass_fds=(*inherited, *program.inherits), start_new_session=True
        )
        try:
            running = Process(process, near_ends)
        except BaseException:
            process.kill()
            process.wait()
            raise
        ours.pop_all()
    return running


def _in_words(code: int) -> str:
    if code >= 0:
        return f"it ended with exit code {code}"
    try:
        return f"it was ended by {signal.Signals(-code).name}"
    except ValueError:
        return f"it was ended by signal {-code}"
