"""How a grid becomes bytes: the one place that says it, for digests, the store, the wire and the journal.

The bytes of a grid are its cells, one byte each, row by row from row 0, which has the smallest y. *Packed* they are
zlib of that. Anyone who reads them knows the placement already, so nothing is ever unpacked beyond its cells.
"""

import hashlib
import zlib

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec

_QUICK = 1
"""Level of zlib: the higher ones take ten times as long and save a tenth of a map, most of which is one value."""


def cell_bytes(cells: NDArray[np.uint8]) -> memoryview:
    """Return the bytes of ``uint8[rows, cols]``; not a copy, which would keep other threads waiting."""
    return np.ascontiguousarray(cells, np.uint8).data.cast("B")


def cells_of(data: bytes | memoryview, spec: GridSpec) -> NDArray[np.uint8]:
    """Return ``uint8[rows, cols]``, read-only, from the bytes of a grid.

    Raises:
        ValueError: they are not as many as the cells.
    """
    if len(data) != spec.rows * spec.cols:
        raise ValueError(f"{len(data)} bytes for {spec.rows} x {spec.cols} cells")
    return np.frombuffer(data, np.uint8).reshape(spec.shape)


def packed_cells(cells: NDArray[np.uint8]) -> bytes:
    """Return the packed bytes of ``uint8[rows, cols]``; takes a second for the largest map."""
    return zlib.compress(cell_bytes(cells), _QUICK)


def unpacked_cells(packed: bytes | memoryview, spec: GridSpec) -> NDArray[np.uint8]:
    """Return ``uint8[rows, cols]``, read-only, from the packed bytes of a grid. Takes no more memory than that.

    Raises:
        ValueError: they are no zlib, or not as many as the cells, or the grid is larger than a map can be.
    """
    if max(spec.shape) > MAX_SIDE_CELLS:
        raise ValueError(f"expected at most {MAX_SIDE_CELLS} cells along a side, got {spec.rows} x {spec.cols}")
    expected = spec.rows * spec.cols
    unpacking = zlib.decompressobj()
    try:
        # One more shows that there is more, without unpacking it.
        data = unpacking.decompress(packed, expected + 1)
    except zlib.error as error:
        raise ValueError(f"cells cannot be unpacked: {error}") from error
    if len(data) != expected or not unpacking.eof or unpacking.unused_data:
        many = "more" if len(data) > expected or unpacking.unused_data else f"{len(data)}"
        raise ValueError(f"expected {expected} bytes of cells for {spec.rows} x {spec.cols}, got {many}")
    return cells_of(data, spec)


def grid_digest(spec: GridSpec, cells: NDArray[np.uint8]) -> str:
    """Return the SHA-256 of placement and cells, in hexadecimal: equal exactly if the maps are."""
    # !r: the shortest text that reads back to the same float, so equal texts are equal placements.
    place = f"{spec.resolution_m!r} {spec.origin_x_m!r} {spec.origin_y_m!r} {spec.rows} {spec.cols}\n"
    found = hashlib.sha256(place.encode())
    found.update(cell_bytes(cells))
    return found.hexdigest()
