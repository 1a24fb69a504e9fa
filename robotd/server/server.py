"""The server whole: lock, sockets, commands and publisher."""

import asyncio
import contextlib
import secrets
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import zmq
import zmq.asyncio

from robotd.client.endpoints import DEFAULT_RUNTIME_DIR, Endpoints
from robotd.contract.events import Event
from robotd.core.bounds import Within, refuse_outside
from robotd.core.broadcast import Subscription
from robotd.core.errors import TransportError
from robotd.server.commands import Commands
from robotd.server.control import Control
from robotd.server.handlers import Handlers
from robotd.server.lock import lock_directory
from robotd.server.outcomes import Outcomes
from robotd.server.outlet import Outlet
from robotd.server.publisher import DEPTH, Publisher
from robotd.server.router import Router

_SOCKET_MODE = 0o770
"""Connecting takes the right to write: the daemon's user and group have it, others do not."""
_ROOM_TO_REFUSE = 4
"""A request up to this many times too large is answered with ``too_large``; beyond, libzmq hangs up on the client."""
_LONGEST_SUBSCRIPTION = 256
"""In bytes, far more than any topic: it is all that readers ever send."""
_MOST = 1_000_000
"""Longest queue, in messages."""
_LINGER_MS = 100
"""How long the last replies may take to leave when the server ends."""


@dataclass(frozen=True, slots=True)
class ServerSettings:
    """Where and how clients are served."""

    runtime_dir: str = DEFAULT_RUNTIME_DIR
    """Directory of the sockets and of the lock that keeps a second daemon out."""
    lease_s: Annotated[float, Within(0.1, 10.0, "s")] = 0.5
    """How long a mission may go without ``renew`` from its client, unless the client asks for another lease [s]."""
    routine_hz: Annotated[float, Within(0.1, 1000.0, "Hz")] = 20.0
    """Odometry, predicted poses and sweep progress are published at most this often [Hz]."""
    max_request_bytes: Annotated[int, Within(1024, 2**24, "bytes")] = 65536
    """Largest request that is read; larger ones are refused."""
    max_pending_requests: Annotated[int, Within(1, _MOST)] = 32
    """Requests carried out at a time; more are refused as ``busy``. Stops are counted apart."""
    remembered_replies: Annotated[int, Within(1, _MOST)] = 256
    """Replies kept so that a repeated request is not carried out twice."""
    state_queue: Annotated[int, Within(1, _MOST)] = 256
    """Messages that wait for a slow reader before it misses some."""
    map_queue: Annotated[int, Within(1, _MOST)] = 8
    """Map messages that wait for a slow reader before it misses some."""

    def __post_init__(self) -> None:
        """Refuse what cannot work."""
        if not self.runtime_dir:
            raise ValueError("runtime_dir must not be empty")
        refuse_outside(self)


class Server:
    """Serves one daemon to its clients."""

    def __init__(self, settings: ServerSettings, control: Control) -> None:
        """Prepare; nothing is opened yet.

        Raises:
            TransportError: the runtime directory's path is too long for a Unix socket.
        """
        self._settings = settings
        self._control = control
        self._endpoints = Endpoints(Path(settings.runtime_dir))
        self.session = secrets.token_hex(8)
        """Changes with every start, so that clients notice one."""
        self.serving = asyncio.Event()
        """Set while clients can connect."""

    async def run(self) -> None:
        """Serve until cancelled.

        Raises:
            TransportError: another daemon serves from this directory, or the sockets cannot be had.
        """
        with lock_directory(self._endpoints.runtime_dir):
            async with self._sockets() as (commands, state, maps):
                self.serving.set()
                try:
                    with self._control.events.subscribe(DEPTH) as events:
                        outlets = Outlet(state, self.session), Outlet(maps, self.session)
                        await self._serve(commands, events, *outlets)
                finally:
                    self.serving.clear()

    async def _serve(
        self, router: zmq.asyncio.Socket, events: Subscription[Event], state: Outlet, maps: Outlet
    ) -> None:
        settings = self._settings
        outcomes = Outcomes()
        commands = Commands(
            Router(router),
            Handlers(self._control, outcomes, self.session, settings.lease_s),
            max_bytes=settings.max_request_bytes,
            max_pending=settings.max_pending_requests,
            remembered=settings.remembered_replies,
        )
        publisher = Publisher(self._control, events, state, maps, routine_hz=settings.routine_hz)
        async with asyncio.TaskGroup() as group:
            group.create_task(outcomes.follow(self._control.events), name="outcomes")
            group.create_task(publisher.run(), name="publisher")
            group.create_task(commands.run(), name="commands")

    @contextlib.asynccontextmanager
    async def _sockets(self) -> AsyncIterator[tuple[zmq.asyncio.Socket, zmq.asyncio.Socket, zmq.asyncio.Socket]]:
        context = zmq.asyncio.Context()
        sockets = context.socket(zmq.ROUTER), context.socket(zmq.XPUB), context.socket(zmq.XPUB)
        try:
            self._remove_sockets()  # of a daemon that was killed: by the lock no other serves from them
            # Options before bind: they hold for connections made afterwards.
            self._set_up(*sockets)
            for socket, path in zip(sockets, self._endpoints.paths, strict=True):
                _bind(socket, path)
            yield sockets
        finally:
            for socket in sockets:
                socket.close(_LINGER_MS)
            await asyncio.to_thread(context.term)  # waits for the lingering, which the loop must not
            with contextlib.suppress(TransportError):  # the next one to serve here will see to it, and complain
                self._remove_sockets()

    def _set_up(self, commands: zmq.asyncio.Socket, state: zmq.asyncio.Socket, maps: zmq.asyncio.Socket) -> None:
        settings = self._settings
        commands.setsockopt(zmq.MAXMSGSIZE, _ROOM_TO_REFUSE * settings.max_request_bytes)
        commands.setsockopt(zmq.SNDHWM, settings.max_pending_requests)
        commands.setsockopt(zmq.RCVHWM, settings.max_pending_requests)
        commands.setsockopt(zmq.ROUTER_HANDOVER, 1)  # a client that reconnects keeps its identity
        for socket, queue in ((state, settings.state_queue), (maps, settings.map_queue)):
            # Else only the first subscription to a topic is heard of, and later readers would not be greeted.
            socket.setsockopt(zmq.XPUB_VERBOSE, 1)
            socket.setsockopt(zmq.MAXMSGSIZE, _LONGEST_SUBSCRIPTION)
            socket.setsockopt(zmq.SNDHWM, queue)

    def _remove_sockets(self) -> None:
        for path in self._endpoints.paths:
            try:
                path.unlink(missing_ok=True)
            except OSError as error:
                raise TransportError(f"socket {path}: cannot be removed: {error.strerror}") from error


def _bind(socket: zmq.asyncio.Socket, path: Path) -> None:
    try:
        socket.bind(f"ipc://{path}")
        path.chmod(_SOCKET_MODE)
    except (zmq.ZMQError, OSError) as error:
        raise TransportError(f"socket {path}: {error.strerror}") from error
