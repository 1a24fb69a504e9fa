"""The console's files."""

from aiohttp import web

from robotd.core.errors import ServerError
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http.route import Needs, Route


async def index(request: web.Request, house: House, _: Person | None) -> web.StreamResponse:
    """Serve the page; it is asked for each time, so that a new console is found."""
    if not house.files.are_built:
        raise ServerError("not_found", "the console was not built: python -m robotd.gateway.web.bundle does it")
    return _served(request, house, "index.html")


async def file(request: web.Request, house: House, _: Person | None) -> web.StreamResponse:
    """Serve what the page needs."""
    return _served(request, house, f"app/{request.match_info['name']}")


def _served(request: web.Request, house: House, name: str) -> web.Response:
    found = house.files.find(name)
    if found is None:
        raise ServerError("not_found", f"no file {name}")
    headers = {
        "Content-Type": found.content_type,
        "Cache-Control": "public, max-age=31536000, immutable" if found.is_named_by_content else "no-cache",
        "Vary": "Accept-Encoding",
    }
    if found.packed is not None and "gzip" in request.headers.get("Accept-Encoding", ""):
        return web.Response(body=found.packed, headers={**headers, "Content-Encoding": "gzip"})
    return web.Response(body=found.data, headers=headers)


ROUTES = (
    Route("GET", "/", Needs.NOBODY, "the console", index),
    Route("GET", "/app/{name}", Needs.NOBODY, "its files, named by their content", file),
)
