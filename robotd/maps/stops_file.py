"""The file ``stops.bin`` of a stored map: what it was made of.

A line that says what it is and of which format, then zlib of a msgpack map: ``settings`` and ``arithmetic`` as
:class:`~robotd.grid.map_stops.MapStops` has them, the columns of :mod:`robotd.maps.stop_columns` and, if the map has
layers, theirs. Its checksum is in the manifest.
"""

import zlib
from dataclasses import asdict, fields
from typing import Annotated, Any

import msgspec

from robotd.core.errors import MapError
from robotd.grid.map_stops import MapStops
from robotd.grid.settings import BetweenBeams, GridSettings
from robotd.maps.stop_columns import LayerColumns, StopColumns, columns_of, layers_of, stops_of

FORMAT, FORMAT_WITH_LAYERS = 1, 2
STOPS_MAX = 1 << 14
"""Bounds what a damaged file can ask for; the longest mission has a thousand."""
READINGS_MAX = 1 << 19
"""Of all stops and layers together: a thousand stops of 500, the most that one mission makes, take 26 MB in memory."""
LAYERS_MAX = 64
"""A mission has eight at most, and they may change."""
_UNPACKED_MAX_BYTES = 32 << 20
"""More than that many stops and readings take; nothing is unpacked beyond it."""
_HEAD = b"robotd stops "
_LEVEL = 6


SETTINGS_SINCE: dict[str, Any] = {"between_beams": BetweenBeams.UNSEEN}
"""What settings that came later were when a file did not have them yet: not what they are by default now."""


# Layers are left out where there are none: such a file is what it was before there were layers.
class _Content(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    settings: dict[str, Any]
    arithmetic: Annotated[str, msgspec.Meta(max_length=16)]
    columns: StopColumns
    layers: Annotated[tuple[LayerColumns, ...], msgspec.Meta(max_length=LAYERS_MAX)] = ()


def encode_stops(stops: MapStops) -> bytes:
    """Return the bytes of the file.

    Raises:
        MapError: it could not be read again: there are too many readings, or numbers that no robot has.
    """
    content = _Content(asdict(stops.settings), stops.arithmetic, columns_of(stops.stops), layers_of(stops.stops))
    # So that a version of before there were layers says what it lacks.
    form = FORMAT_WITH_LAYERS if content.layers else FORMAT
    data = _HEAD + b"%d\n" % form + zlib.compress(msgspec.msgpack.encode(content), _LEVEL)
    # Before anything is written: what is reported saved must be found again.
    if decode_stops(data) != stops:
        raise MapError("the stops would not come back as they are")
    return data


def decode_packed_stops(packed: bytes) -> MapStops:
    """Return what the file says, packed as it goes between processes and into recordings. MapError as the file's."""
    try:
        data = _unpacked(packed)
    except (ValueError, zlib.error) as error:
        raise MapError(f"packed stops are damaged: {error}") from error
    return decode_stops(data)


def decode_stops(data: bytes) -> MapStops:
    """Return what the file says.

    Raises:
        MapError: it is cut, altered, of another format, or contradicts itself. To find out takes less than 100 MiB.
    """
    head, line_end, packed = data.partition(b"\n")
    if not line_end or not head.startswith(_HEAD):
        raise MapError(f"it does not begin with {_HEAD.decode()!r}")
    if head not in {_HEAD + b"%d" % form for form in (FORMAT, FORMAT_WITH_LAYERS)}:
        named = head[len(_HEAD) : len(_HEAD) + 20].decode(errors="replace")
        raise MapError(f"it has format {named!r}, this version reads formats {FORMAT} and {FORMAT_WITH_LAYERS}")
    try:
        content = msgspec.msgpack.decode(_unpacked(packed), type=_Content)
        stops = stops_of(content.columns, content.layers, STOPS_MAX, READINGS_MAX)
        return MapStops(_settings_of(content.settings), stops, content.arithmetic)
    except (ValueError, zlib.error, RecursionError) as error:
        raise MapError(str(error)[:200]) from error


def _settings_of(said: dict[str, Any]) -> GridSettings:
    unknown = said.keys() - {field.name for field in fields(GridSettings)}
    if unknown:
        raise ValueError(f"settings: it has {str(sorted(unknown))[:80]}, which this version does not know")
    return msgspec.convert(SETTINGS_SINCE | said, GridSettings)


def _unpacked(packed: bytes) -> bytes:
    unpacking = zlib.decompressobj()
    data = unpacking.decompress(packed, _UNPACKED_MAX_BYTES)
    if not unpacking.eof or unpacking.unused_data:
        raise ValueError("expected the end of its zlib where the file ends")
    return data
