"""All addresses in one table, and what is made of it: the server, and its description for programs."""

from typing import Any

from aiohttp import web

from robotd import __version__
from robotd.gateway.browser.console_protocol import LONGEST_TEXT
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http import (
    foxglove_socket,
    map_exchange,
    map_pictures,
    page_socket,
    recorded_files,
    robot_state,
    signing_in,
    static,
    stop_pages,
)
from robotd.gateway.http.front_door import FrontDoor
from robotd.gateway.http.route import Needs, Route


async def described(_: web.Request, _house: House, _person: Person | None) -> web.StreamResponse:
    """Describe all addresses as OpenAPI."""
    return web.json_response(openapi())


ROUTES: tuple[Route, ...] = (
    *(*static.ROUTES, *signing_in.ROUTES, *page_socket.ROUTES, *stop_pages.ROUTES),
    *(*robot_state.ROUTES, *map_pictures.ROUTES, *map_exchange.ROUTES, *recorded_files.ROUTES, *foxglove_socket.ROUTES),
    Route("GET", "/api/openapi.json", Needs.VIEWER, "this description", described),
)


def application(house: House, more: tuple[Route, ...] = ()) -> web.Application:
    """Return the server's side of the table, and of ``more`` routes that others made."""
    door = FrontDoor(house)
    # Its own bound on what is read into memory; what comes as a file has a bound of its own.
    app = web.Application(middlewares=[door.middleware], client_max_size=LONGEST_TEXT)
    for route in (*ROUTES, *more):
        app.router.add_route(route.method, route.path, door.guard(route))
    return app


def openapi() -> dict[str, Any]:
    """Return the table as OpenAPI 3.1."""
    paths: dict[str, dict[str, Any]] = {}
    for route in ROUTES:
        security: list[dict[str, list[str]]] = [] if route.needs is Needs.NOBODY else [{"cookie": []}, {"token": []}]
        names = [part[1:-1] for part in route.path.replace(".", "/").split("/") if part.startswith("{")]
        paths.setdefault(route.path, {})[route.method.lower()] = {
            "summary": f"{route.summary} ({route.needs.value})",
            "security": security,
            "parameters": [
                {"name": name, "in": "path", "required": True, "schema": {"type": "string"}} for name in names
            ],
            "responses": {"default": {"description": "an answer, or a problem: code, message, where"}},
        }
    return {
        "openapi": "3.1.0",
        "info": {"title": "robotd-gateway", "version": __version__},
        "paths": paths,
        "components": {
            "securitySchemes": {
                "cookie": {"type": "apiKey", "in": "cookie", "name": "robotd_PORT"},
                "token": {"type": "http", "scheme": "bearer"},
            }
        },
    }
