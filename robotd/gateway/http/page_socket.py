"""The socket of a page: greeted, asked, told, and hung up on when it reads nothing or says too much."""

import asyncio
import contextlib
from functools import partial

from aiohttp import WSCloseCode, web

from robotd import __version__
from robotd.contract.requests import REQUESTS
from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.errors import ServerError
from robotd.gateway.browser import console_protocol as protocol
from robotd.gateway.browser.liveness import EVERY_S
from robotd.gateway.browser.page_connection import PageConnection, Person
from robotd.gateway.house import House
from robotd.gateway.http.route import Needs, Route
from robotd.gateway.http.socket_duties import Item, first_of, read, write


async def serve(request: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """Serve a page for as long as it lives."""
    if person is None:
        raise ServerError("not_signed_in", "sign in first")
    house.crowd.enter(person.session)
    try:
        socket = web.WebSocketResponse(
            protocols=(protocol.SUBPROTOCOL,), max_msg_size=protocol.LONGEST_TEXT, compress=False, timeout=1.0
        )
        await socket.prepare(request)
        await _serve(socket, PageConnection(person, house.services), house)
        return socket
    finally:
        house.crowd.leave(person.session)


async def _serve(socket: web.WebSocketResponse, connection: PageConnection, house: House) -> None:
    services = house.services
    connection.say(_hello(connection, house))
    # Without a wait between: what comes from now on follows on what is greeted with, and nothing is missed or
    # told twice.
    connection.outbox.greet(services.fan.join(connection))
    house.connections.add(connection)
    services.enter(connection)
    try:
        await first_of(
            read(socket, connection, "a page sends text"),
            write(connection, partial(_send, socket)),
            _question(connection),
        )
    finally:
        services.fan.leave(connection)
        house.connections.discard(connection)
        services.leave(connection)
        house.dropped_messages += connection.outbox.dropped
        await connection.end()
        with contextlib.suppress(ConnectionError, TimeoutError):
            async with asyncio.timeout(1.0):
                # A frame that closes has room for 123 bytes of a reason.
                await socket.close(code=WSCloseCode.POLICY_VIOLATION, message=(connection.ended or "").encode()[:120])


def _hello(connection: PageConnection, house: House) -> str:
    return protocol.hello(
        gateway=__version__,
        console=house.files.version,
        robot=house.settings.robot.name,
        name=connection.person.name,
        role=connection.person.role,
        browser=connection.driver.browser,
        commands=list(REQUESTS),
        time_ns=now_ns(),
        wall_offset_ns=wall_offset_ns(),
        patience_s=house.settings.watching.patience_s,
        unattended=house.settings.watching.unattended,
    )


async def _send(socket: web.WebSocketResponse, item: Item) -> None:
    match item:
        case bytes():
            await socket.send_bytes(protocol.FRAME + item)
        case str():
            await socket.send_str(item)
        case dict():
            await socket.send_str(protocol.lost(item))


async def _question(connection: PageConnection) -> None:
    while True:
        connection.ask()
        await asyncio.sleep(EVERY_S)


ROUTES = (Route("GET", "/api/ws", Needs.VIEWER, "the socket of a page, robotd.console.v1", serve, is_socket=True),)
