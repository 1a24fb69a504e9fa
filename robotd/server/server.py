"""The server whole: sockets, commands and publisher."""

import asyncio
import contextlib
import secrets
from collections.abc import AsyncIterator
from pathlib import Path

import zmq
import zmq.asyncio

from robotd.contract.topics import Published
from robotd.core.broadcast import Subscription
from robotd.core.endpoints import Endpoints
from robotd.core.errors import TransportError
from robotd.server.commands import Commands
from robotd.server.control import Control
from robotd.server.handlers import Handlers
from robotd.server.outlet import Outlet
from robotd.server.publisher import DEPTH, Publisher
from robotd.server.router import Router
from robotd.server.settings import ServerSettings

_SOCKET_MODE = 0o770
"""Connecting takes the right to write: the daemon's user and group have it, others do not."""
_ROOM_TO_REFUSE = 4
"""A request up to this many times too large is answered with ``too_large``; beyond, libzmq hangs up on the client."""
_LONGEST_SUBSCRIPTION = 256
"""In bytes, far more than any topic: it is all that readers ever send."""
_LINGER_MS = 100
"""How long the last replies may take to leave when the server ends."""


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
        """Serve until cancelled; the runtime directory must be there, and ours alone.

        Raises:
            TransportError: the sockets cannot be had.
        """
        async with self._sockets() as (commands, state, maps):
            self.serving.set()
            try:
                with self._control.events.subscribe(DEPTH) as events:
                    outlets = Outlet(state, self.session), Outlet(maps, self.session)
                    await self._serve(commands, events, *outlets)
            finally:
                self.serving.clear()

    async def _serve(
        self, router: zmq.asyncio.Socket, events: Subscription[Published], state: Outlet, maps: Outlet
    ) -> None:
        settings = self._settings
        commands = Commands(
            Router(router),
            Handlers(self._control, self.session, settings.lease_s),
            max_bytes=settings.max_request_bytes,
            max_pending=settings.max_pending_requests,
            remembered=settings.remembered_replies,
        )
        publisher = Publisher(self._control, events, state, maps)
        async with asyncio.TaskGroup() as group:
            group.create_task(publisher.run(), name="publisher")
            group.create_task(commands.run(), name="commands")

    @contextlib.asynccontextmanager
    async def _sockets(self) -> AsyncIterator[tuple[zmq.asyncio.Socket, zmq.asyncio.Socket, zmq.asyncio.Socket]]:
        context = zmq.asyncio.Context()
        sockets = context.socket(zmq.ROUTER), context.socket(zmq.XPUB), context.socket(zmq.XPUB)
        try:
            self._remove_sockets()  # of a server that was killed: the runtime directory is ours alone
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
