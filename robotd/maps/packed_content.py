"""The files of a map on their way between two processes: packed, for a map is mostly of one value."""

import zlib
from dataclasses import dataclass

from robotd.core.errors import MapError
from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec
from robotd.maps.version_files import Content

_QUICK = 1
"""Level of zlib, as of :mod:`robotd.core.grid_bytes`."""
_LONGEST_FILE = MAX_SIDE_CELLS**2 + 2**20
"""Bytes: a byte a cell, and a head."""


@dataclass(frozen=True, slots=True)
class PackedContent:
    """As :class:`.Content`, the files packed."""

    spec: GridSpec
    digest: str
    files: dict[str, bytes]
    stops: int | None

    @classmethod
    def of(cls, content: Content, *leave_out: str) -> "PackedContent":
        """Pack all files but some; takes a second for the largest map, and leaves the interpreter to others."""
        files = {name: zlib.compress(data, _QUICK) for name, data in content.files.items() if name not in leave_out}
        return cls(content.spec, content.digest, files, content.stops)

    def unpacked(self) -> Content:
        """Return the files as they were.

        Raises:
            MapError: one is not packed as it should be, or longer than files are; never more is unpacked.
        """
        files = {name: _unpacked(name, data) for name, data in self.files.items()}
        return Content(self.spec, self.digest, files, self.stops)


def _unpacked(name: str, data: bytes) -> bytes:
    unpacking = zlib.decompressobj()
    try:
        file = unpacking.decompress(data, _LONGEST_FILE)
    except zlib.error as error:
        raise MapError(f"{name} cannot be unpacked: {error}") from error
    if not unpacking.eof or unpacking.unused_data:
        raise MapError(f"{name} cannot be unpacked: it is cut off, too long, or goes on")
    return file
