"""The sockets that clients connect to: who is let in, and who is shown out when there is no room.

Room is for all, so it is taken from those who have most of it: a process with too many connections loses its oldest
one, and so does the process with most of them when the house is full; a client that lets too much wait for it is cut
off first where all that waits is too much. Each is counted, and said in the log.
"""

import asyncio
import logging
import socket
from collections import Counter
from pathlib import Path

from robotd.core.errors import TransportError
from robotd.core.log_limit import LogLimit
from robotd.server.client_connection import Connection, Manners, Owner, PeerProcess

MOST = 384
"""Connections altogether, a client has up to three; far below what the process may open."""
MOST_OF_A_PROCESS = 96
_SOCKET_MODE = 0o770
"""Connecting takes the right to write: the daemon's user and group have it, others do not."""
_BACKLOG = 128
_AT_A_TURN = 32
"""Let in, before others have their turn."""
_AFTER_ERROR_S = 0.1
"""A socket that fails again and again must not keep the loop busy."""
_WAITING_BYTES = 2**28
"""Of all that waits to be taken by clients."""
_LOOK_EVERY_S = 0.1

log = logging.getLogger(__name__)


class Door:
    """Listens, and keeps the connections of all its sockets within bounds."""

    def __init__(self, *, most: int = MOST, most_of_a_process: int = MOST_OF_A_PROCESS) -> None:
        self.shown_out = 0
        """How many connections were cut off or refused."""
        self._most = most
        self._most_of_a_process = most_of_a_process
        self._listening: list[tuple[socket.socket, Path]] = []
        self._inside: dict[Connection, None] = {}
        """In the order they came."""
        self._complaints = LogLimit()
        self._loop = asyncio.get_running_loop()
        self._look = self._loop.call_later(_LOOK_EVERY_S, self._look_who_takes_nothing)

    def open(self, path: Path, manners: Manners, owner: Owner) -> None:
        """Listen at a path, where a socket of a server that was killed may lie.

        Raises:
            TransportError: it cannot be had.
        """
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            _remove(path)
            listening.setblocking(False)
            listening.bind(str(path))
            # Between binding and listening: nobody can connect while the mode is still what the process's mask
            # made it.
            path.chmod(_SOCKET_MODE)
            listening.listen(_BACKLOG)
        except OSError as error:
            listening.close()
            raise TransportError(f"socket {path}: {error.strerror}") from error
        except TransportError:
            listening.close()
            raise
        self._listening.append((listening, path))
        self._loop.add_reader(listening, self._let_in, listening, manners, owner)

    def close(self) -> None:
        """End all connections, and listen no more."""
        self._look.cancel()
        for listening, path in self._listening:
            self._loop.remove_reader(listening)
            listening.close()
            path.unlink(missing_ok=True)
        for connection in tuple(self._inside):
            connection.close()

    @property
    def waiting_bytes(self) -> int:
        """Of all that waits to be taken by clients."""
        return sum(connection.waiting_bytes for connection in self._inside)

    def _let_in(self, listening: socket.socket, manners: Manners, owner: Owner) -> None:
        for _ in range(_AT_A_TURN):
            try:
                end, _ = listening.accept()
            except (BlockingIOError, InterruptedError, ConnectionAbortedError):
                return
            except OSError as error:  # no descriptor left, for one: who waits outside waits a little longer
                self._complain(f"a client could not be let in: {error.strerror}")
                self._loop.remove_reader(listening)
                self._loop.call_later(_AFTER_ERROR_S, self._listen_again, listening, manners, owner)
                return
            connection = Connection(end, manners, owner, self._over)
            if connection.is_open:
                self._inside[connection] = None
                self._make_room(connection)

    def _listen_again(self, listening: socket.socket, manners: Manners, owner: Owner) -> None:
        if listening.fileno() >= 0:  # not closed since
            self._loop.add_reader(listening, self._let_in, listening, manners, owner)

    def _make_room(self, newest: Connection) -> None:
        of_processes = Counter(connection.process for connection in self._inside)
        if of_processes[newest.process] > self._most_of_a_process:
            self._oldest_of(newest.process).close(f"its process has more than {self._most_of_a_process} connections")
        elif len(self._inside) > self._most:
            process, count = of_processes.most_common(1)[0]
            # The oldest of the largest, not the newest of all: a program that leaks connections must not keep
            # others out.
            victim = newest if count == 1 else self._oldest_of(process)
            victim.close(f"there are more than {self._most} connections")

    def _oldest_of(self, process: PeerProcess) -> Connection:
        return next(connection for connection in self._inside if connection.process == process)

    def _look_who_takes_nothing(self) -> None:
        while self.waiting_bytes > _WAITING_BYTES:
            worst = max(self._inside, key=lambda connection: connection.waiting_bytes)
            worst.close(f"it let {worst.waiting_bytes} bytes wait")
        self._look = self._loop.call_later(_LOOK_EVERY_S, self._look_who_takes_nothing)

    def _over(self, connection: Connection, why: str) -> None:
        self._inside.pop(connection, None)
        if why:
            self.shown_out += 1
            self._complain(f"a client ({connection.process}) was cut off: {why}; {self.shown_out} so far")

    def _complain(self, text: str) -> None:
        if line := self._complaints.line(text):
            log.warning("%s", line)


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise TransportError(f"socket {path}: cannot be removed: {error.strerror}") from error
