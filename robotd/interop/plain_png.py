"""A grey picture as PNG by the standard library alone: pages with a picture in them need no extra."""

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_EIGHT_BIT_GREY = bytes((8, 0, 0, 0, 0))


def grey_png(grey: NDArray[np.uint8]) -> bytes:
    """Return ``uint8[rows, cols]`` as a PNG; row 0 is the top."""
    rows, cols = grey.shape
    # Before each row stands how it is filtered: not at all.
    lines = np.zeros((rows, cols + 1), np.uint8)
    lines[:, 1:] = grey
    header = struct.pack(">II", cols, rows) + _EIGHT_BIT_GREY
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(lines.tobytes(), 9)), (b"IEND", b""))
    return _SIGNATURE + b"".join(_chunk(kind, data) for kind, data in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
