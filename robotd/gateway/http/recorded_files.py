"""Recordings to be downloaded, and what is made of them: those in the daemon's folder, by name, and nothing else."""

import re
from pathlib import Path

from aiohttp import web

from robotd.core.errors import ServerError
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http.route import Needs, Route
from robotd.gateway.made_files import FORMS, Form

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,127}\.mcap")


async def listed(_: web.Request, house: House, _person: Person | None) -> web.StreamResponse:
    """List them, the newest first."""
    return web.json_response({"recordings": _found(Path(house.settings.robot.recordings))})


async def download(request: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """Send one as it is, or what is made of it; ranges are honoured, so that a broken download goes on."""
    name = request.match_info["name"]
    folder = Path(house.settings.robot.recordings)
    known = {str(one["name"]) for one in _found(folder)}
    if name in known:
        return _sent(folder / name, name, "application/octet-stream")
    recording, form = _form_of(name)
    if form is None or recording not in known:
        raise ServerError("not_found", f"no recording {name[:64]}")
    if person is None:
        raise ServerError("not_signed_in", "sign in first")
    with house.services.noted(person.name, person.whence, f"make {name}"):
        made = await house.made.of(folder / recording, form)
    return _sent(made, f"{recording.removesuffix('.mcap')}{form.ending}", form.media_type)


def _sent(file: Path, name: str, media_type: str) -> web.FileResponse:
    headers = {"Content-Disposition": f'attachment; filename="{name}"', "Content-Type": media_type}
    return web.FileResponse(file, headers=headers)


def _form_of(name: str) -> tuple[str, Form | None]:
    """Return the recording that a name begins with, and what is to be made of it; None if that is nothing."""
    for form in FORMS:
        if name.endswith(form.ending):
            return name.removesuffix(form.ending), form
    return name, None


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
    Route(
        "GET",
        "/api/recordings/{name}",
        Needs.VIEWER,
        "a recording as it is; with .html, .foxglove.mcap or .bag.zip behind its name what is made of it",
        download,
    ),
)
