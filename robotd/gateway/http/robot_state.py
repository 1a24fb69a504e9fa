"""The robot by HTTP, for programs: its state, and commands that are no mission."""

from typing import Any

import msgspec
from aiohttp import web

from robotd.core.clock import now_ns
from robotd.core.errors import ServerError
from robotd.gateway.access.roles import Role
from robotd.gateway.browser.asked_by_page import request_of
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.feed.heard_frames import fields_of
from robotd.gateway.house import House
from robotd.gateway.http.route import Needs, Route
from robotd.gateway.http.signing_in import body_of

_HEARD_WITHIN_S = 2.5
_LARGE = {"map_changed", "rank_map"}
"""Bytes, which have no place in an object of JSON: maps have addresses of their own."""


async def state(_: web.Request, house: House, _person: Person | None) -> web.StreamResponse:
    """Tell what a page that joins is told, but for the map's cells."""
    snapshot = house.services.fan.snapshot
    told = [fields_of(data) for data in snapshot.frames()]
    events: dict[str, Any] = {
        fields["event"]: fields for fields in told if fields["event"] not in {*_LARGE, "log", "sweep_readings"}
    }
    lines = [fields for fields in told if fields["event"] == "log"]
    body = {"session": snapshot.session, "silent_s": snapshot.silent_s(now_ns()), "events": events, "log": lines}
    return web.Response(body=msgspec.json.encode(body), content_type="application/json")


async def command(request: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """Carry out a command of the daemon's; its arguments are the object that is sent."""
    if person is None:
        raise ServerError("not_signed_in", "sign in first")
    name = request.match_info["name"]
    with house.services.noted(person.name, person.whence, name):
        asked = request_of(name, await body_of(request, dict[str, Any]), person.role)
        answer = await house.services.commands.carry_out(asked, person.name)
    return web.Response(body=msgspec.json.encode(answer), content_type="application/json")


async def audit(_: web.Request, house: House, _person: Person | None) -> web.StreamResponse:
    """Tell who did what."""
    return web.Response(body=msgspec.json.encode(house.services.audit.all), content_type="application/json")


async def access(_: web.Request, house: House, _person: Person | None) -> web.StreamResponse:
    """Tell who may come in; no secret is in it, nor any hash of one."""
    tokens = [
        {
            "name": one.name,
            "role": one.role,
            "made_unix_s": one.made_unix_s,
            "expires_unix_s": one.expires_unix_s,
            "is_used_up": not one.sha256,
        }
        for one in house.tokens.all
    ]
    sessions = [
        {
            "name": one.token,
            "role": one.role,
            "begun_unix_s": one.begun_unix_s,
            "seen_unix_s": one.seen_unix_s,
            "ended_unix_s": one.ended_unix_s,
            "pages": sum(page.person.session == one.sha256 for page in house.connections),
        }
        for one in house.sessions.all
    ]
    return web.json_response({"tokens": tokens, "sessions": sessions, "roles": list(Role)})


async def health(_: web.Request, house: House, _person: Person | None) -> web.StreamResponse:
    """Say that this process lives."""
    return web.json_response({"alive": True, "browsers": len(house.connections)})


async def ready(_: web.Request, house: House, _person: Person | None) -> web.StreamResponse:
    """Say whether the daemon is heard."""
    silent_s = house.services.fan.snapshot.silent_s(now_ns())
    is_heard = silent_s is not None and silent_s < _HEARD_WITHIN_S
    return web.json_response({"daemon_heard": is_heard, "silent_s": silent_s}, status=200 if is_heard else 503)


ROUTES = (
    Route("GET", "/api/state", Needs.VIEWER, "what a page that joins is told", state),
    Route("POST", "/api/command/{name}", Needs.VIEWER, "a command of the daemon; most need an operator", command),
    Route("GET", "/api/audit", Needs.OPERATOR, "who did what", audit),
    Route("GET", "/api/access", Needs.ADMIN, "tokens and sessions", access),
    Route("GET", "/healthz", Needs.NOBODY, "whether the gateway lives", health),
    Route("GET", "/readyz", Needs.NOBODY, "whether the daemon is heard", ready),
)
