"""What is told of a stored map: to clients, and to who takes it into use."""

import msgspec

from robotd.contract.answers import MapEntryInfo
from robotd.contract.arguments import Stops
from robotd.contract.ways import Point
from robotd.core.text import printable
from robotd.exploring.errand import Errand
from robotd.maps.entry import MapEntry


def entry_info(entry: MapEntry) -> MapEntryInfo:
    """Return what clients are told of a stored version."""
    rows, cols = entry.spec.shape if entry.spec else (0, 0)
    return MapEntryInfo(
        name=entry.name,
        version=entry.version,
        digest=entry.digest,
        created_unix_ns=entry.created_unix_ns,
        rows=rows,
        cols=cols,
        resolution_m=entry.spec.resolution_m if entry.spec else 0.0,
        # It may quote a file that somebody else wrote.
        damage=None if entry.damage is None else printable(entry.damage),
        unsaved=entry.is_unsaved,
        stops=entry.stops,
    )


BUMPS, ERRAND = "bumps_m", "exploring"
"""Keys of the metadata that say where the robot bumped into something, and how far exploring the map has come."""


def bumps_of(entry: MapEntry) -> tuple[Point, ...]:
    """Return where the robot bumped into something on a stored map; nothing where that was written by other hands."""
    try:
        return msgspec.convert(entry.metadata.get(BUMPS, ()), Stops)
    # A map is worth more than its remarks: one with odd metadata still loads.
    except msgspec.ValidationError:
        return ()


def errand_of(entry: MapEntry) -> Errand | None:
    """Return how far exploring a stored map has come; None where that is not known, or was written by other hands."""
    try:
        return msgspec.convert(entry.metadata.get(ERRAND), Errand | None)
    except msgspec.ValidationError:  # as above
        return None
