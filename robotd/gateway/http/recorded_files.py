"""Recordings to be downloaded: those that lie in the daemon's folder, by name, and nothing else."""

import re
from pathlib import Path

from aiohttp import web

from robotd.core.errors import ServerError
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http.route import Needs, Route

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,127}\.mcap")


async def listed(_: web.Request, house: House, _person: Person | None) -> web.StreamResponse:
    """List them, the newest first."""
    return web.json_response({"recordings": _found(Path(house.settings.robot.recordings))})


async def download(request: web.Request, house: House, _: Person | None) -> web.StreamResponse:
    """Send one as it is; ranges are honoured, so that a broken download goes on."""
    name = request.match_info["name"]
    folder = Path(house.settings.robot.recordings)
    if not _NAME.fullmatch(name) or name not in {one["name"] for one in _found(folder)}:
        raise ServerError("not_found", f"no recording {name[:64]}")
    headers = {"Content-Disposition": f'attachment; filename="{name}"', "Content-Type": "application/octet-stream"}
    return web.FileResponse(folder / name, headers=headers)


def _found(folder: Path) -> list[dict[str, str | int | float]]:
    try:
        files = [path for path in folder.iterdir() if _NAME.fullmatch(path.name)]
        # Not through a link: it may lead anywhere.
        marks = [(path.name, path.lstat()) for path in files if path.is_file() and not path.is_symlink()]
    except OSError:
        return []
    newest_first = sorted(marks, key=lambda one: -one[1].st_mtime)
    return [{"name": name, "bytes": mark.st_size, "changed_unix_s": mark.st_mtime} for name, mark in newest_first]


ROUTES = (
    Route("GET", "/api/recordings", Needs.VIEWER, "recordings, the newest first", listed),
    Route("GET", "/api/recordings/{name}", Needs.VIEWER, "a recording as it is", download),
)
