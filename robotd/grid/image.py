"""Maps as pictures for people and other programs: PGM, and the three greys of ROS's map_server.

Pure codecs, bytes in, bytes out. A picture's top row is the one of largest y; arrays in the daemon begin with the
smallest. The flip happens in :func:`encode_pgm` and :func:`decode_pgm` and nowhere else.
"""

import re

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import MapError

OCCUPIED_THRESH = 0.65
FREE_THRESH = 0.196
"""map_server's own figure; with the 0.25 that it also accepts, an unknown pixel of 205 would load as free."""
OCCUPIED_GREY, UNKNOWN_GREY, FREE_GREY = 0, 205, 254

_HEADER = re.compile(rb"P5(?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,9})\s")
_MAX_PIXELS = 1 << 26
_SURE = 255


def encode_pgm(grey: NDArray[np.uint8]) -> bytes:
    """Return the binary PGM (P5) of ``uint8[rows, cols]`` whose row 0 has the smallest y."""
    rows, cols = grey.shape
    return b"P5\n%d %d\n255\n" % (cols, rows) + np.ascontiguousarray(grey[::-1]).tobytes()


def decode_pgm(data: bytes) -> NDArray[np.uint8]:
    """Return the pixels of a binary PGM, ``uint8[rows, cols]``, row 0 with the smallest y.

    Raises:
        MapError: the header is damaged, the size absurd, a pixel is not one byte, or there are too few or too many.
    """
    header = _HEADER.match(data)
    if header is None:
        raise MapError("the image is not a binary PGM (P5), or its header is damaged")
    cols, rows, maxval = (int(number) for number in header.groups())
    if maxval != _SURE:
        raise MapError(f"the image has {maxval} as its white, expected 255")
    if not 0 < cols * rows <= _MAX_PIXELS:
        raise MapError(f"the image claims an absurd size, {cols} x {rows}")
    found = len(data) - header.end()
    if found != rows * cols:
        raise MapError(f"the image is damaged: {cols} x {rows} pixels announced, {found} bytes found")
    pixels = np.frombuffer(data, np.uint8, offset=header.end())
    return pixels.reshape(rows, cols)[::-1].copy()


def trinary_from_cells(cells: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return map_server's three greys for 8-bit cells, with ``p = value / 255`` as the probability of an obstacle.

    ``p >= 0.65`` (166 and more) is black, ``p <= 0.196`` (49 and less) is white, and what lies between is 205,
    unknown: 128, which is a cell never seen, and cells whose evidence is too weak or contradicts itself.
    """
    probability = np.arange(256) / _SURE
    grey = np.full(256, UNKNOWN_GREY, np.uint8)
    grey[probability >= OCCUPIED_THRESH] = OCCUPIED_GREY
    grey[probability <= FREE_THRESH] = FREE_GREY
    return grey[cells]


def cells_from_trinary(
    grey: NDArray[np.uint8],
    *,
    negate: bool = False,
    occupied_thresh: float = OCCUPIED_THRESH,
    free_thresh: float = FREE_THRESH,
) -> NDArray[np.uint8]:
    """Return 8-bit cells for the pixels of a map_server image (mode trinary): 255, 0, or 128 for unknown.

    The comparison is made in float64 from whole pixels: 205 is 0.19608, a hair above 0.196.
    """
    pixel = np.arange(256)
    probability = (pixel if negate else _SURE - pixel) / _SURE
    cells = np.full(256, 128, np.uint8)
    cells[probability <= free_thresh] = 0
    cells[probability >= occupied_thresh] = _SURE
    return cells[grey]
