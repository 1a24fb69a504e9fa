"""A map that a client brings, in as many requests as its bytes need: none is larger than a request may be."""

import hashlib
from collections.abc import Iterator
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from robotd.contract.answers import MapEntryInfo
from robotd.contract.arguments import Coordinate, MapName
from robotd.contract.request import Request
from robotd.core.grid_bytes import packed_cells
from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec

LONGEST_MAP = MAX_SIDE_CELLS**2 + 2**16
"""Bytes: the largest map of cells that cannot be packed, and what zlib adds to it."""
LONGEST_PART = 2**15
"""Bytes: half of what a daemon reads of one request, unless it is told otherwise."""
_Side = Annotated[int, Meta(ge=1, le=MAX_SIDE_CELLS)]
_Sha256 = Annotated[str, Meta(pattern=r"\A[0-9a-f]{64}\Z")]


class MapImported(msgspec.Struct, frozen=True):
    """How much of a map has come, or the map in the store."""

    received_bytes: int
    """From its beginning; the next part goes on there."""
    map: MapEntryInfo | None
    """None until the last part came."""


class MapImport(Request[MapImported], frozen=True):
    """Bring a part of a map; with the last one it is checked and stored as a new version, and not taken into use."""

    # As long as to save one: the last part waits for a writer's turn, and for the disk.
    cmd, result, deadline_s = "map_import", MapImported, 60.0
    name: MapName
    imported_from: Annotated[str, Meta(max_length=200)]
    """What it was before, for people."""
    resolution_m: Annotated[float, Meta(ge=0.001, le=100.0)]
    origin_x_m: Coordinate
    origin_y_m: Coordinate
    rows: _Side
    cols: _Side
    sha256: _Sha256
    """Of all bytes of its packed cells (:mod:`robotd.core.grid_bytes`): by it the parts know each other."""
    size_bytes: Annotated[int, Meta(ge=1, le=LONGEST_MAP)]
    """How many those are."""
    offset_bytes: Annotated[int, Meta(ge=0, le=LONGEST_MAP)]
    """Where this part begins."""
    part: Annotated[bytes, Meta(min_length=1)]

    @property
    def spec(self) -> GridSpec:
        """Where its grid lies."""
        return GridSpec(self.resolution_m, self.origin_x_m, self.origin_y_m, (self.rows, self.cols))

    @classmethod
    def parts(
        cls, name: str, spec: GridSpec, cells: NDArray[np.uint8], imported_from: str = ""
    ) -> "Iterator[MapImport]":
        """Yield the requests that bring a map of ``uint8[rows, cols]``, to be sent one after the other."""
        packed = packed_cells(cells)
        sha256 = hashlib.sha256(packed).hexdigest()
        place = (spec.resolution_m, spec.origin_x_m, spec.origin_y_m, spec.rows, spec.cols)
        for offset in range(0, len(packed), LONGEST_PART):
            part = packed[offset : offset + LONGEST_PART]
            yield cls(name, imported_from, *place, sha256, len(packed), offset, part)
