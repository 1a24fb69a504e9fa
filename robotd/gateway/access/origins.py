"""Where a request comes from: a page of ours, or a page of somebody else that uses our visitor's browser.

Two attacks are meant. A page elsewhere sends a request with our cookie (forged requests), and a name that somebody
else owns is made to point at us, so that his page is of our origin (rebinding).
"""

from collections.abc import Mapping
from urllib.parse import urlsplit

from robotd.core.errors import ServerError

_LOCAL_NAMES = ("localhost", "127.0.0.1", "[::1]")
_SAFE = {"GET", "HEAD", "OPTIONS"}


def host_of(name: str) -> str:
    """Return the name in a ``Host`` header, without its port.

    >>> host_of("robot.lab:8470"), host_of("[::1]:8470"), host_of("[::1]")
    ('robot.lab', '[::1]', '[::1]')
    """
    if name.startswith("["):
        return name.partition("]")[0].lower() + "]"
    return name.partition(":")[0].lower()


def check_host(host: str | None, allowed: tuple[str, ...]) -> None:
    """Return if a request names us.

    Raises:
        ServerError: it names somebody else.
    """
    if host is None or host_of(host) not in {*_LOCAL_NAMES, *(name.lower() for name in allowed)}:
        raise ServerError("wrong_host", f"this robot is not called {host}: add the name to allowed_hosts if it is")


def check_origin(method: str, headers: Mapping[str, str], scheme: str, *, is_socket: bool = False) -> None:
    """Return if a request that changes something, or opens a socket, was made by a page of ours.

    Raises:
        ServerError: it was not, or nothing shows that it was.
    """
    if method in _SAFE and not is_socket:
        return
    # What the browser itself says first: no page can set it; the origin decides where a browser is too old to
    # say it.
    site = headers.get("Sec-Fetch-Site")
    if site is not None and site != "same-origin":
        raise ServerError("wrong_origin", f"a page of another site made this request ({site})")
    origin, host = headers.get("Origin"), headers.get("Host")
    # Every browser sends one with what changes something; who is no browser brings a token and comes another
    # way.
    if origin is None:
        raise ServerError("wrong_origin", "a request that changes something says its Origin, or brings a bearer token")
    try:
        found = urlsplit(origin)
        is_ours = (found.scheme, found.netloc.lower()) == (scheme, (host or "").lower())
    except ValueError:  # no address at all
        is_ours = False
    if not is_ours:
        raise ServerError("wrong_origin", f"a page of {origin} made this request, and this is {scheme}://{host}")
