"""Stored maps as files of other programs, and such files as maps to be stored."""

import asyncio
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from aiohttp import BodyPartReader, web

from robotd.contract.arguments import MapName
from robotd.contract.map_import import MapImport
from robotd.contract.plain import to_plain
from robotd.core.errors import MapError, ServerError
from robotd.core.text import printable
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http.route import Needs, Route
from robotd.gateway.http.stored_map import KEPT, stored_map

if TYPE_CHECKING:
    from robotd.interop.map_server import ImportedMap

LONGEST_UPLOAD = 64 << 20
"""Bytes of all files of a map together."""
_MOST_FILES = 2
_UNSEEN = 128
_KINDS = ("pgm", "yaml", "zip")


async def file(request: web.Request, house: House, _: Person | None) -> web.StreamResponse:
    """Send a stored map as the picture that every program reads, its yaml, or both in a zip that keeps every value."""
    kind = request.match_info["kind"]
    if kind not in _KINDS:
        raise ServerError("not_found", f"a map is png, {', '.join(_KINDS)}")
    shown = await stored_map(request, house)
    stem = f"{request.match_info['name']}-{request.match_info['version']}"
    data = await asyncio.to_thread(_file, stem, shown.spec, shown.values, kind)
    headers = {**KEPT, "Content-Disposition": f'attachment; filename="{stem}.{kind}"'}
    return web.Response(body=data, content_type="application/octet-stream", headers=headers)


def _file(stem: str, spec: Any, values: Any, kind: str) -> bytes:
    from robotd.interop.map_bundle import bundle_of, files_of  # noqa: PLC0415  # loads Pillow, which is seldom needed

    return bundle_of(stem, spec, values) if kind == "zip" else files_of(stem, spec, values, "trinary")[f"{stem}.{kind}"]


class _Asked(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What stands behind the question mark."""

    name: MapName | None = None
    """What it shall be called in the store; without one it is looked at, and that is all."""
    resolution_m: float | None = None
    """Of a picture alone."""


@dataclass(frozen=True, slots=True)
class _Found:
    """A map, and what people are told of it before it is stored."""

    read: "ImportedMap"
    told: dict[str, Any]


async def bring(request: web.Request, house: House, person: Person | None) -> web.StreamResponse:
    """Read the files of a map and say what was found; under a name, store it as a new version."""
    if person is None:
        raise ServerError("not_signed_in", "sign in first")
    try:
        asked = msgspec.convert(dict(request.query), _Asked, strict=False)
    except msgspec.ValidationError as error:
        raise ServerError("bad_argument", str(error)) from error
    if house.importing.locked():
        raise ServerError("busy", "another map is being imported")
    async with house.importing:
        files = await _uploaded(request)
        try:
            found = await asyncio.to_thread(_read, files, asked.resolution_m)
        except MapError as error:
            raise ServerError("bad_argument", str(error)) from error
        if asked.name is None:
            return web.json_response(found.told)
        with house.services.noted(person.name, person.whence, f"map_import {asked.name}"):
            stored = await _store(house, person, asked.name, ", ".join(files)[:200], found.read)
    return web.json_response({**found.told, "map": stored})


def _read(files: dict[str, bytes], resolution_m: float | None) -> _Found:
    from robotd.interop.map_bundle import map_of_files  # noqa: PLC0415  # loads Pillow, which is seldom needed

    read = map_of_files(files, resolution_m)
    spec, cells = read.grid.spec, read.grid.cells
    told = {
        "rows": spec.rows,
        "cols": spec.cols,
        "resolution_m": spec.resolution_m,
        "free_cells": int(np.count_nonzero(cells < _UNSEEN)),
        "unknown_cells": int(np.count_nonzero(cells == _UNSEEN)),
        "occupied_cells": int(np.count_nonzero(cells > _UNSEEN)),
        "notes": list(read.notes),
    }
    return _Found(read, told)


async def _store(house: House, person: Person, name: str, source: str, read: "ImportedMap") -> Any:
    """Bring a map to the daemon, part by part; return what it is in the store."""
    parts = await asyncio.to_thread(lambda: list(MapImport.parts(name, read.grid.spec, read.grid.cells, source)))
    for part in parts:
        answer = await house.services.asker.ask(part, who=f"{person.name}, in the console")
    return to_plain(answer.map)


async def _uploaded(request: web.Request) -> dict[str, bytes]:
    """Return the files that a request brings, by name.

    Raises:
        ServerError: it brings none, or too many, or too much.
    """
    if request.content_type != "multipart/form-data":
        raise ServerError("malformed", "send the files of a map as multipart/form-data")
    files: dict[str, bytes] = {}
    left = LONGEST_UPLOAD
    try:
        async for field in await request.multipart():
            name = PurePosixPath(getattr(field, "filename", None) or "").name
            if not isinstance(field, BodyPartReader) or not name or len(files) == _MOST_FILES:
                raise ServerError("malformed", f"expected the files of one map, at most {_MOST_FILES}")
            data = await _whole(field, left)
            left -= len(data)
            files[printable(name, 100)] = data
    except ValueError as error:
        raise ServerError("malformed", f"no files can be read of this: {printable(str(error))}") from error
    if not files:
        raise ServerError("malformed", "no file came")
    return files


async def _whole(field: BodyPartReader, most: int) -> bytes:
    data = bytearray()
    while chunk := await field.read_chunk(1 << 16):
        data += chunk
        if len(data) > most:
            raise ServerError("too_large", f"the files of a map may have {LONGEST_UPLOAD >> 20} MiB together")
    return bytes(data)


ROUTES = (
    Route(
        "GET",
        "/api/maps/{name}/{version}.{kind}",
        Needs.VIEWER,
        "a stored map for other programs: picture, yaml, or both with every value kept",
        file,
    ),
    Route(
        "POST",
        "/api/maps",
        Needs.OPERATOR,
        "what the files of a map of another program are; under ?name= it is stored",
        bring,
    ),
)
