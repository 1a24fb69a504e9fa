"""The files of a map on their way between two processes: packed, for a map is mostly of one value."""

import zlib
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from robotd.core.errors import MapError
from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec
from robotd.maps.atomic import Blocks
from robotd.maps.manifest import Manifest
from robotd.maps.version_files import IMAGE, YAML, Content, checked_blocks, files_of

_EXPORTS = (IMAGE, YAML)
_QUICK = 1
"""Level of zlib, as of :mod:`robotd.core.grid_bytes`."""
_LONGEST_FILE = MAX_SIDE_CELLS**2 + 2**20
"""Bytes: a byte a cell, and a head."""
_BLOCK_BYTES = 2**20
_PACKED_BYTES = 2**16
"""Unpacked at a time: what zlib leaves of its input for want of room is copied."""


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
        files = {name: b"".join(blocks) for name, blocks in self.blocks().items()}
        return Content(self.spec, self.digest, files, self.stops)

    def blocks(self) -> Mapping[str, Blocks]:
        """Return the files as they were, unpacked as they are taken; MapError then, as for :meth:`unpacked`."""
        return {name: _Unpacked(name, data) for name, data in self.files.items()}


@dataclass(frozen=True, slots=True)
class _Unpacked:
    """A file, unpacked again each time it is asked for.

    Whole it would be 64 MiB, and zlib puts what is large together while it holds the interpreter: the thread that
    writes a map would keep the heart's loop for 20 ms.
    """

    name: str
    data: bytes

    def __iter__(self) -> Iterator[bytes]:
        unpacking, left = zlib.decompressobj(), _LONGEST_FILE
        for begin in range(0, len(self.data), _PACKED_BYTES):
            packed: bytes | memoryview = memoryview(self.data)[begin : begin + _PACKED_BYTES]
            while block := self._next(unpacking, packed):
                left -= len(block)
                if left < 0:
                    raise self._damaged("it is longer than files are")
                yield block
                packed = unpacking.unconsumed_tail
        if not unpacking.eof or unpacking.unused_data:
            raise self._damaged("it is cut off, or goes on")

    def _next(self, unpacking: "zlib._Decompress", packed: bytes | memoryview) -> bytes:
        try:
            return unpacking.decompress(packed, _BLOCK_BYTES)
        except zlib.error as error:
            raise self._damaged(str(error)) from error

    def _damaged(self, why: str) -> MapError:
        return MapError(f"{self.name} cannot be unpacked: {why}")


def _packed(blocks: Iterable[bytes]) -> bytes:
    packing = zlib.compressobj(_QUICK)
    return b"".join((*map(packing.compress, blocks), packing.flush()))
