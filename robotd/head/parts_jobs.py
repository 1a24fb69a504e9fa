"""The job of a map that comes in parts."""

import msgspec

from robotd.core.grid_spec import GridSpec
from robotd.head.job import Job
from robotd.head.jobs import FilesMade


class PartTaken(msgspec.Struct, frozen=True):
    """How much of a map that comes in parts is there."""

    received_bytes: int
    made: FilesMade | None
    """What the store writes of it, once all is there."""


class TakePart(Job[PartTaken], frozen=True):
    """Take a part of the packed cells of a map that a client brings; with the last one, make what the store writes.

    MapError if it does not go on where the last one ended, or if the whole is no map. Of the map nothing is held then.
    """

    name, answer = "take part", PartTaken
    spec: GridSpec
    sha256: str
    """Of all parts together."""
    size_bytes: int
    offset_bytes: int
    part: bytes
