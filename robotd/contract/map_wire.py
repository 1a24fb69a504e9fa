"""A map as bytes: changed cells as they are, a whole map compressed."""

import msgspec
import numpy as np
from numpy.typing import NDArray

from robotd.contract.events import MapChanged
from robotd.core.errors import RemoteProtocolError
from robotd.core.grid_bytes import packed_cells, unpacked_cells
from robotd.core.grid_spec import GridSpec

_INDEX = np.dtype("<u4")
"""Wide enough: the largest map has 2^26 cells."""


class MapPayload(msgspec.Struct, frozen=True):
    """A :class:`MapChanged` on the wire."""

    time_ns: int
    map_id: str | None
    generation: int
    whole: bool
    resolution_m: float
    origin_x_m: float
    origin_y_m: float
    rows: int
    cols: int
    cells_zlib: bytes = b""
    """The whole grid, packed as :mod:`robotd.core.grid_bytes` says; empty unless ``whole``."""
    indices_u32le: bytes = b""
    """Changed cells, ``row * cols + col`` in four bytes each, little-endian."""
    values_u8: bytes = b""
    """Their values, one byte each."""
    stops: int | None = None
    """How many stops the map is made of by now; None if that is not known."""


def pack_map(change: MapChanged) -> MapPayload:
    """Return a map for the wire. A whole one is compressed, which takes milliseconds: do it off the loop."""
    values = np.ascontiguousarray(change.values, dtype=np.uint8)
    spec = change.spec
    return MapPayload(
        time_ns=change.time_ns,
        map_id=change.map_id,
        generation=change.generation,
        whole=change.whole,
        resolution_m=float(spec.resolution_m),
        origin_x_m=float(spec.origin_x_m),
        origin_y_m=float(spec.origin_y_m),
        rows=int(spec.rows),
        cols=int(spec.cols),
        cells_zlib=_packed(change, values) if change.whole else b"",
        indices_u32le=b"" if change.whole else change.cells.astype(_INDEX).tobytes(),
        values_u8=b"" if change.whole else values.tobytes(),
        stops=change.stops,
    )


def _packed(change: MapChanged, values: NDArray[np.uint8]) -> bytes:
    return packed_cells(values) if change.packed is None else bytes(change.packed)


def unpack_map(payload: MapPayload) -> MapChanged:
    """Return the map that was sent.

    Raises:
        RemoteProtocolError: it contradicts itself.
    """
    try:
        spec = GridSpec(payload.resolution_m, payload.origin_x_m, payload.origin_y_m, (payload.rows, payload.cols))
        cells, values = _unpack_whole(payload, spec) if payload.whole else _unpack_changes(payload, spec)
    except ValueError as error:
        raise RemoteProtocolError(f"map payload: {error}") from error
    return MapChanged(
        payload.time_ns, payload.map_id, payload.generation, spec, payload.whole, cells, values, payload.stops
    )


def _unpack_whole(payload: MapPayload, spec: GridSpec) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
    return np.empty(0, dtype=np.intp), unpacked_cells(payload.cells_zlib, spec)


def _unpack_changes(payload: MapPayload, spec: GridSpec) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
    cells = np.frombuffer(payload.indices_u32le, dtype=_INDEX).astype(np.intp)
    values = np.frombuffer(payload.values_u8, dtype=np.uint8)
    if len(cells) != len(values):
        raise ValueError(f"{len(cells)} indices with {len(values)} values")
    # Looked at before it is used: NumPy would count from the end, or refuse in the middle of a map.
    if len(cells) and int(cells.max()) >= spec.rows * spec.cols:
        raise ValueError(f"index {int(cells.max())} lies outside of {spec.rows} x {spec.cols} cells")
    return cells, values
