"""The server whole: sockets, commands and publisher."""

import asyncio
import contextlib
import secrets
from collections.abc import Iterator
from pathlib import Path

from robotd.core.counted import Counted
from robotd.core.endpoints import Endpoints
from robotd.server.client_connection import Manners
from robotd.server.commands import Commands
from robotd.server.door import Door
from robotd.server.handlers import Handlers
from robotd.server.letters import Letters
from robotd.server.mission_port import MissionPort
from robotd.server.publisher import DEPTH, Publisher
from robotd.server.settings import ServerSettings

_ROOM_TO_REFUSE = 4
"""A request up to this many times too large is answered with ``too_large``; beyond, the client is cut off."""
_MOST_FRAMES = 16
"""Of a request, which should have one, or two with the envelope of a REQ socket."""
_LONGEST_SUBSCRIPTION = 256
"""In bytes, far more than any topic: it is all that readers ever send."""
_REPLY_BYTES = 2**22
"""Of replies that wait for their client, unless it is one alone."""
_STATE_BYTES = 2**24
_MAP_BYTES = 2**26
"""The same of what is published; all readers wait for the same bytes."""
_LAST_REPLIES_S = 0.02
"""How long the last replies may take to leave when the server ends."""


class Server:
    """Serves one daemon to its clients."""

    def __init__(self, settings: ServerSettings, control: MissionPort) -> None:
        """Prepare; nothing is opened yet.

        Raises:
            TransportError: the runtime directory's path is too long for a Unix socket.
        """
        self._settings = settings
        self._control = control
        self._endpoints = Endpoints(Path(settings.runtime_dir))
        # Not a counter, which would begin again with each start, nor a time, which may be set back.
        self.session = secrets.token_hex(8)
        """Changes with every start, so that clients notice one."""
        self._counted = Counted()
        self.serving = asyncio.Event()
        """Set while clients can connect."""

    async def run(self) -> None:
        """Serve until cancelled; the runtime directory must be there, and ours alone.

        Raises:
            TransportError: the sockets cannot be had.
        """
        letters = Letters()
        # Before anything is opened: no event is told between the first client and the first listener.
        with self._control.events.subscribe(DEPTH) as events:
            publisher = Publisher(self._control, events, self.session, self._counted)
            commands = self._commands(letters)
            with self._open(letters, publisher):
                try:
                    async with asyncio.TaskGroup() as group:
                        group.create_task(publisher.run(), name="publisher")
                        group.create_task(commands.run(), name="commands")
                        self.serving.set()
                finally:
                    self.serving.clear()
                    # Else the one who asked the daemon to end would be the one that hears nothing of it.
                    await asyncio.sleep(_LAST_REPLIES_S)

    def _commands(self, letters: Letters) -> Commands:
        settings = self._settings
        return Commands(
            letters,
            Handlers(self._control, self.session, settings.lease_s, self._counted),
            self._counted,
            max_bytes=settings.max_request_bytes,
            max_pending=settings.max_pending_requests,
            remembered=settings.remembered_replies,
        )

    @contextlib.contextmanager
    def _open(self, letters: Letters, publisher: Publisher) -> Iterator[None]:
        settings = self._settings
        asking = Manners(
            socket_type=b"ROUTER",
            peers=frozenset({b"DEALER", b"REQ", b"ROUTER"}),
            longest_bytes=_ROOM_TO_REFUSE * settings.max_request_bytes,
            most_frames=_MOST_FRAMES,
            queue=settings.max_pending_requests,
            queue_bytes=_REPLY_BYTES,
        )
        commands, state, maps = self._endpoints.paths
        door = Door()
        try:
            door.open(commands, asking, letters)
            door.open(state, _listening(settings.state_queue, _STATE_BYTES), publisher.state)
            door.open(maps, _listening(settings.map_queue, _MAP_BYTES), publisher.maps)
            yield
        finally:
            door.close()


def _listening(queue: int, queue_bytes: int) -> Manners:
    return Manners(
        socket_type=b"XPUB",
        peers=frozenset({b"SUB", b"XSUB"}),
        longest_bytes=_LONGEST_SUBSCRIPTION,
        most_frames=1,
        queue=queue,
        queue_bytes=queue_bytes,
    )
