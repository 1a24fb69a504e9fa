"""A version of a stored map that an address names."""

import re

from aiohttp import web

from robotd.contract.events import MapChanged
from robotd.contract.requests import MapShow
from robotd.core.errors import ServerError
from robotd.gateway.house import House

KEPT = {"Cache-Control": "private, max-age=3600"}
"""A version never changes; after a delete its number is not given again."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


async def stored_map(request: web.Request, house: House) -> MapChanged:
    """Return the whole of it.

    Raises:
        ServerError: the address names none, or there is none.
    """
    name, version = request.match_info["name"], request.match_info["version"]
    if not _NAME.fullmatch(name) or not version.isdecimal() or len(version) > 9:
        raise ServerError("not_found", f"no map {name[:64]} {version[:9]}")
    async with house.showing:
        return await house.services.asker.ask(MapShow(name, int(version)))
