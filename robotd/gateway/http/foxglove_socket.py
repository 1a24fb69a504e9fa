"""The socket of Foxglove's app: what the robot tells, live, to who may look."""

import contextlib
from typing import TYPE_CHECKING

from aiohttp import WSCloseCode, web

from robotd.contract.topics import Frame
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError, ServerError
from robotd.gateway.access.tickets import VALID_S
from robotd.gateway.browser.console_protocol import LONGEST_TEXT
from robotd.gateway.browser.foxglove_protocol import SUBPROTOCOLS
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http.route import Needs, Route
from robotd.gateway.http.socket_duties import Item, first_of, read, write

if TYPE_CHECKING:
    from robotd.gateway.browser.foxglove_app import FoxgloveApp

_HEARTBEAT_S = 15.0
"""A robot that stands tells next to nothing, and a proxy cuts what is idle. Pages are asked questions."""


async def serve(request: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """Serve an app for as long as it lives."""
    if person is None:
        raise ServerError("not_signed_in", "bring a token")
    from robotd.gateway.browser.foxglove_app import FoxgloveApp  # noqa: PLC0415  # loads what few gateways need

    house.crowd.enter(person.session)
    try:
        socket = web.WebSocketResponse(
            protocols=SUBPROTOCOLS, max_msg_size=LONGEST_TEXT, compress=False, timeout=1.0, heartbeat=_HEARTBEAT_S
        )
        await socket.prepare(request)
        await _serve(socket, FoxgloveApp(person, house.services), house)
        return socket
    finally:
        house.crowd.leave(person.session)


async def _serve(socket: web.WebSocketResponse, app: "FoxgloveApp", house: House) -> None:
    fan = house.services.fan
    app.greet(house.settings.robot.name, fan.snapshot.session or "", fan.join(app))
    house.connections.add(app)

    async def send(item: Item) -> None:
        match item:
            case str():
                await socket.send_str(item)
            case bytes():
                with contextlib.suppress(RobotdError):  # of another version, say: the next may be understood
                    for message in await app.messages(Frame.of(item)):
                        await (socket.send_str(message) if isinstance(message, str) else socket.send_bytes(message))
        for caught in app.caught_up():
            await socket.send_bytes(caught)

    try:
        await first_of(read(socket, app, "this robot tells, and takes nothing"), write(app, send))
    finally:
        fan.leave(app)
        house.connections.discard(app)
        house.dropped_messages += app.outbox.dropped
        with contextlib.suppress(ConnectionError, TimeoutError):
            await socket.close(code=WSCloseCode.POLICY_VIOLATION, message=(app.ended or "").encode()[:120])


async def ticket(_: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """Make an address at which an app that can bring no token is let in, once."""
    if person is None:
        raise ServerError("not_signed_in", "sign in first")
    path = f"foxglove/{house.tickets.issue(person, now_ns() / NS_PER_S)}"
    return web.json_response({"path": path, "seconds": VALID_S})


ROUTES = (
    Route("GET", "/foxglove", Needs.VIEWER, "what the robot tells, live, for Foxglove's app", serve, is_socket=True),
    Route("GET", "/foxglove/{ticket}", Needs.TICKET, "the same, by an address for one use", serve, is_socket=True),
    Route("POST", "/api/foxglove", Needs.VIEWER, "make such an address", ticket),
)
