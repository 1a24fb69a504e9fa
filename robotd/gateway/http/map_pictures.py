"""Stored maps as pictures, whole or small."""

import asyncio

import numpy as np
from aiohttp import web
from numpy.typing import NDArray

from robotd.contract.events import MapChanged
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http.route import Needs, Route
from robotd.gateway.http.stored_map import KEPT, stored_map

_SMALL_CELLS = 320


async def picture(request: web.Request, house: House, _: Person | None) -> web.StreamResponse:
    """Draw a stored map: whole, or small enough for a card."""
    shown = await stored_map(request, house)
    data = await asyncio.to_thread(_png, shown, small="small" in request.query)
    return web.Response(body=data, content_type="image/png", headers=KEPT)


def _png(shown: MapChanged, *, small: bool) -> bytes:
    from robotd.interop.grey_image import encode_png  # noqa: PLC0415  # loads Pillow, which a gateway seldom needs

    cells = shown.values[::-1]  # a picture begins at the largest y
    return encode_png(255 - (_pooled(cells) if small else cells))


def _pooled(cells: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return cells made few: of each block the darkest, so that no wall gets lost."""
    block = -(-max(cells.shape) // _SMALL_CELLS)
    if block == 1:
        return cells
    rows, cols = (side // block for side in cells.shape)
    blocks = cells[: rows * block, : cols * block].reshape(rows, block, cols, block)
    far = np.abs(blocks.astype(np.int16) - 128)
    seen = np.where(far.max(axis=(1, 3)) == 0, 128, blocks.min(axis=(1, 3)))
    return np.where(blocks.max(axis=(1, 3)) > 128, blocks.max(axis=(1, 3)), seen).astype(np.uint8)


ROUTES = (
    Route(
        "GET", "/api/maps/{name}/{version}.png", Needs.VIEWER, "a stored map as a picture; ?small for a card", picture
    ),
)
