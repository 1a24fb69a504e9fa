"""The files of a map on their way between two processes: packed, for a map is mostly of one value."""

import zlib
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from robotd.core.errors import MapError
from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec
from robotd.maps.manifest import Manifest
from robotd.maps.version_files import IMAGE, YAML, Content, checked_blocks, files_of

_EXPORTS = (IMAGE, YAML)
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
    def of(cls, content: Content) -> "PackedContent":
        """Pack all files; takes a second for the largest map, and leaves the interpreter to others."""
        files = {name: zlib.compress(data, _QUICK) for name, data in content.files.items()}
        return cls(content.spec, content.digest, files, content.stops)

    @classmethod
    def read(cls, path: Path, manifest: Manifest) -> "PackedContent":
        """Pack what the files in a version's directory hold of it, as they are read: none is in memory whole.

        Raises:
            MapError: a file, or an export that is left out here, is missing or was altered; says which.
        """
        files: dict[str, bytes] = {}
        for name in files_of(manifest):
            blocks = checked_blocks(path / name, manifest)
            if name in _EXPORTS:
                deque(blocks, maxlen=0)  # they are looked at, and that is all
            else:
                files[name] = _packed(blocks)
        return cls(manifest.spec, manifest.digest, files, manifest.stops)

    def unpacked(self) -> Content:
        """Return the files as they were.

        Raises:
            MapError: one is not packed as it should be, or longer than files are; never more is unpacked.
        """
        files = {name: _unpacked(name, data) for name, data in self.files.items()}
        return Content(self.spec, self.digest, files, self.stops)


def _packed(blocks: Iterable[bytes]) -> bytes:
    packing = zlib.compressobj(_QUICK)
    return b"".join((*map(packing.compress, blocks), packing.flush()))


def _unpacked(name: str, data: bytes) -> bytes:
    unpacking = zlib.decompressobj()
    try:
        file = unpacking.decompress(data, _LONGEST_FILE)
    except zlib.error as error:
        raise MapError(f"{name} cannot be unpacked: {error}") from error
    if not unpacking.eof or unpacking.unused_data:
        raise MapError(f"{name} cannot be unpacked: it is cut off, too long, or goes on")
    return file
