"""Signing in and out, and who somebody is."""

from typing import Any

import msgspec
from aiohttp import web

from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.errors import ServerError
from robotd.gateway.access.tokens import SECRET_LENGTH
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House, unix_s
from robotd.gateway.http.front_door import FrontDoor, address_of, cookie_name, path_of, scheme_of
from robotd.gateway.http.route import Needs, Route

_YEAR_S = 365 * 86400


class _SignIn(msgspec.Struct, forbid_unknown_fields=True):
    token: str


async def body_of(request: web.Request, kind: Any) -> Any:
    """Return the object that a request brings.

    Raises:
        ServerError: it brings none, or another one.
    """
    if request.content_type != "application/json":
        raise ServerError("malformed", "send an object as application/json")
    try:
        return msgspec.json.decode(await request.read(), type=kind)
    except msgspec.DecodeError as error:
        raise ServerError("malformed", str(error)) from error


async def sign_in(request: web.Request, house: House, _: Person | None) -> web.StreamResponse:
    """Exchange a token for a cookie."""
    secret = (await body_of(request, _SignIn)).token
    whence = address_of(request, house.settings.listen.trusted_proxies)
    if len(secret) > SECRET_LENGTH:
        secret = ""  # a token of another length is none, however long it is
    person = FrontDoor(house).by_token(secret, whence)
    token = house.tokens.named(person.name)
    if token is None:
        raise ServerError("wrong_token", "the token was revoked just now")
    cookie, _session = house.sessions.begin(token, unix_s())
    house.sign_ins += 1
    await house.save_sessions()
    house.services.audit.note(now_ns() + wall_offset_ns(), person.name, whence, "sign in", "done")
    response = web.json_response({"name": person.name, "role": person.role})
    response.set_cookie(
        cookie_name(house, request),
        cookie,
        max_age=_YEAR_S,  # the session ends sooner; who was signed in within a day may still stop
        path=path_of(request, house.settings.listen.trusted_proxies),
        secure=scheme_of(request, house.settings.listen.trusted_proxies) == "https",
        httponly=True,
        samesite="Strict",
    )
    return response


async def sign_out(request: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """End the session."""
    session = house.sessions.find(request.cookies.get(cookie_name(house, request), ""), unix_s())
    if session is not None and person is not None:
        house.sessions.end(session, unix_s())
        house.drop(session)
        await house.save_sessions()
        house.services.audit.note(now_ns() + wall_offset_ns(), person.name, person.whence, "sign out", "done")
    return web.Response(status=204)


async def who(_: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """Tell who is signed in."""
    if person is None:
        raise ServerError("not_signed_in", "sign in first")
    return web.json_response({"name": person.name, "role": person.role, "robot": house.settings.robot.name})


ROUTES = (
    Route("POST", "/api/session", Needs.NOBODY, "exchange a token for a cookie", sign_in),
    Route("GET", "/api/session", Needs.VIEWER, "who is signed in", who),
    Route("DELETE", "/api/session", Needs.VIEWER, "sign out", sign_out),
)
