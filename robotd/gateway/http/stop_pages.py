"""STOP by POST: for pages, beside their socket; for programs; and as one button on a page without a script."""

from html import escape

from aiohttp import web

from robotd.core.errors import ServerError
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http.route import Needs, Route

_PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>STOP {robot}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="app/stop.css">
<main>
<h1>{robot}</h1>
<form method="post" action="stop"><button>STOP</button></form>
<p role="status">{said}</p>
<p>This is a software stop, of this program. The emergency stop is on the robot. <a href="./">Console</a></p>
</main>
</html>
"""


async def stop(_: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """Stop the robot; answered when the daemon has confirmed it."""
    return web.json_response({"took_ms": round(1000.0 * await _stopped(house, person), 1)})


async def show(_: web.Request, house: House, _person: Person | None) -> web.StreamResponse:
    """Show the page with the button that stops the robot, which works without scripts."""
    return _page(house, "")


async def press(_: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """Stop, and say so on the page with the button."""
    try:
        return _page(house, f"STOPPED in {1000.0 * await _stopped(house, person):.0f} ms")
    except ServerError:
        return _page(house, "STOP NOT CONFIRMED: use the emergency stop on the robot")


async def _stopped(house: House, person: Person | None) -> float:
    if person is None:
        raise ServerError("not_signed_in", "sign in first")
    return await house.services.stop(person.name, person.whence)


def _page(house: House, said: str) -> web.Response:
    text = _PAGE.format(robot=escape(house.settings.robot.name), said=escape(said))
    return web.Response(text=text, content_type="text/html")


ROUTES = (
    Route("POST", "/api/stop", Needs.STOP, "stop the robot", stop),
    Route("GET", "/stop", Needs.STOP, "a page with one button and no script", show),
    Route("POST", "/stop", Needs.STOP, "stop the robot, from that page", press),
)
