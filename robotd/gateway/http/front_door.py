"""Every request comes through here: is it for us, by whom, may they, and what must every answer say."""

import hashlib
import ipaddress
import logging
from collections.abc import Awaitable, Callable

from aiohttp import web

from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError, ServerError
from robotd.gateway.access.origins import check_host, check_origin
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House, unix_s
from robotd.gateway.http import http_problems as problems
from robotd.gateway.http.route import Needs, Route

HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self';"
        " font-src 'self'; manifest-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=(), payment=(), usb=()",
}

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]

log = logging.getLogger(__name__)


def address_of(request: web.Request, trusted: tuple[str, ...]) -> str:
    """Return where a request comes from; a proxy that is trusted says it for others. For logs and limits alone."""
    peer = request.remote or "unknown"
    # The last of them, which the proxy itself added: those before it the visitor may have written.
    told = request.headers.get("X-Forwarded-For", "").rpartition(",")[2].strip()
    # Believed from a proxy alone: anyone else could be from whichever address is not limited yet.
    if peer not in trusted or not told:
        return peer
    try:
        return str(ipaddress.ip_address(told))
    except ValueError:
        return peer


def scheme_of(request: web.Request, trusted: tuple[str, ...]) -> str:
    """Return how the browser came in: a trusted proxy has TLS where we have none."""
    if request.remote in trusted and request.headers.get("X-Forwarded-Proto") == "https":
        return "https"
    return request.scheme


def path_of(request: web.Request, trusted: tuple[str, ...]) -> str:
    """Return the path of the console as the browser sees it: a proxy may have put it below another one."""
    prefix = request.headers.get("X-Forwarded-Prefix", "").rstrip("/")
    return f"{prefix}/" if request.remote in trusted and prefix.startswith("/") else "/"


def cookie_name(house: House, request: web.Request) -> str:
    """Return what our cookie is called: other robots on this host, behind other ports or paths, have theirs.

    By its path too, though a browser goes by that itself: below ours it sends the cookie of ``/`` as well.
    """
    path = path_of(request, house.settings.listen.trusted_proxies)
    below = "" if path == "/" else f"_{hashlib.sha256(path.encode()).hexdigest()[:12]}"
    return f"robotd_{house.settings.listen.port or request.url.port}{below}"


class FrontDoor:
    """Lets requests in."""

    def __init__(self, house: House) -> None:
        self._house = house

    def guard(self, route: Route) -> Handler:
        """Return what answers a route."""

        async def answer(request: web.Request) -> web.StreamResponse:
            try:
                person = self._person(request, route)
                return await route.answer(request, self._house, person)
            except ServerError as error:
                return problems.problem(error, request.path)
            except RobotdError as error:
                return problems.problem(ServerError("internal", str(error)), request.path)

        return answer

    @web.middleware
    async def middleware(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Answer what has no route in the same form, and say what every answer says."""
        try:
            response = await handler(request)
        except web.HTTPException as error:
            response = problems.of_status(error.status, error.reason, request.path)
        except Exception:
            log.exception("%s %s", request.method, request.path)
            response = problems.problem(
                ServerError("internal", "a fault of the gateway; its log has more"), request.path
            )
        if not response.prepared:
            response.headers.update(HEADERS)
            response.headers.setdefault("Cache-Control", "no-store")
        return response

    def _person(self, request: web.Request, route: Route) -> Person | None:
        """Return who asks; None where everybody may.

        Raises:
            ServerError: they may not.
        """
        if route.needs is Needs.STOP:
            return self._who_may_stop(request)
        check_host(request.headers.get("Host"), self._house.settings.listen.allowed_hosts)
        if route.needs is Needs.TICKET:
            return self._by_ticket(request.match_info["ticket"])
        whence = address_of(request, self._house.settings.listen.trusted_proxies)
        scheme, secret = request.headers.get("Authorization", "").partition(" ")[::2]
        # Its origin is not asked: no browser sends a token of its own accord, so no other site can let it.
        if scheme.lower() == "bearer" and route.needs is not Needs.NOBODY:
            return self._checked(self.by_token(secret, whence), route)
        check_origin(
            request.method,
            request.headers,
            scheme_of(request, self._house.settings.listen.trusted_proxies),
            is_socket=route.is_socket,
        )
        if route.needs is Needs.NOBODY:
            return None
        found = self._house.sessions.find(request.cookies.get(cookie_name(self._house, request), ""), unix_s())
        if found is None:
            raise ServerError("not_signed_in", "sign in first: this needs a session")
        return self._checked(Person(found.token, found.role, whence, found.sha256), route)

    def by_token(self, secret: str, whence: str) -> Person:
        """Return who brings a token.

        Raises:
            ServerError: it is none, or too many wrong ones came from there.
        """
        now_s = now_ns() / NS_PER_S
        self._house.wrong_tokens.refuse(whence, now_s)
        token = self._house.match(secret)
        if token is None:
            self._house.wrong_tokens.note(whence, now_s)
            self._house.refused_sign_ins += 1
            raise ServerError("wrong_token", "no such token: robotctl gateway token new makes one")
        return Person(token.name, token.role, whence, token.sha256)

    def _by_ticket(self, ticket: str) -> Person:
        # Of no account which page brings it: it is a secret of its own, for one use, and gives a viewer's rights.
        person = self._house.tickets.use(ticket, now_ns() / NS_PER_S)
        if person is None:
            raise ServerError("not_signed_in", "this address was used, or is too old: ask for another one")
        return person

    def _checked(self, person: Person, route: Route) -> Person:
        needed = route.needs.role
        if needed is not None and not person.role.may(needed):
            raise ServerError("not_allowed", f"this needs the role {needed}, and {person.name} has {person.role}")
        return person

    def _who_may_stop(self, request: web.Request) -> Person:
        """Return who stops: anyone who signed in within a day; neither host, origin, role nor limit is asked."""
        whence = address_of(request, self._house.settings.listen.trusted_proxies)
        secret = request.cookies.get(cookie_name(self._house, request), "")
        session = self._house.sessions.may_stop(secret, unix_s())
        if session is not None:
            return Person(session.token, session.role, whence, session.sha256)
        scheme, secret = request.headers.get("Authorization", "").partition(" ")[::2]
        # Of those in memory, by which none is used up: nothing stands between a press and the stop, a disk
        # neither.
        token = self._house.tokens.match(secret, unix_s()) if scheme.lower() == "bearer" else None
        if token is None:
            raise ServerError("not_signed_in", "to stop the robot sign in: robotctl stop does it on the robot itself")
        return Person(token.name, token.role, whence, token.sha256)
