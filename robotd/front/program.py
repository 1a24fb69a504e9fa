"""The front: a server for clients, whose mission lives in the heart. The same in a process and in memory."""

from collections.abc import Sequence
from typing import NoReturn

from robotd import __version__
from robotd.children.channel import Channel
from robotd.children.inside import live
from robotd.core.errors import ChildError
from robotd.core.together import together
from robotd.front.front_side import FrontSide
from robotd.front.messages import settings_of
from robotd.server.server import Server


async def serve_clients(life: Channel, lanes: Sequence[Channel]) -> NoReturn:
    """Serve clients until the heart hangs up.

    Raises:
        ChildError: it did.
        TransportError: the sockets cannot be had.
    """
    stops, requests = lanes
    settings = settings_of(await requests.receive())
    mission = FrontSide(stops, requests)
    server = Server(settings, mission)
    await together(mission.run(), server.run(), _live(life, server))


async def _live(life: Channel, server: Server) -> NoReturn:
    # Ready only when a client could connect: until then the heart counts it as not there.
    await server.serving.wait()
    await live(life, __version__)
    raise ChildError("the heart hung up")
