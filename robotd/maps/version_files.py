"""The files of one version of a map: ``manifest.json, cells.bin, stops.bin, map.pgm, map.yaml``.

``cells.bin`` is the grid (:mod:`robotd.core.grid_bytes`), ``stops.bin`` what it was made of (not there if that is not
known); ``map.pgm`` and ``map.yaml`` are exports for other programs. Here they are bytes with checksums; what they mean
is known to :mod:`robotd.maps.grid_files`.
"""

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.maps.atomic import Blocks
from robotd.maps.manifest import FileSum, Manifest, decode_manifest

MANIFEST, CELLS, STOPS, IMAGE, YAML = "manifest.json", "cells.bin", "stops.bin", "map.pgm", "map.yaml"
_MANIFEST_MAX_BYTES = 1 << 20
_BLOCK_BYTES = 1 << 20


class Storable(Protocol):
    """What a version is made of: its files but for the manifest, in pieces, and what that says of them."""

    @property
    def spec(self) -> GridSpec:
        """Where its cells lie."""

    @property
    def digest(self) -> str:
        """Of the grid."""

    @property
    def stops(self) -> int | None:
        """How many stops ``stops.bin`` has; None if there is none."""

    def blocks(self) -> Mapping[str, Blocks]:
        """Return its files by name; MapError, while they are taken, if one is not as it should be."""


@dataclass(frozen=True, slots=True)
class Content:
    """As :class:`Storable`, the files whole."""

    spec: GridSpec
    digest: str
    files: dict[str, bytes]
    stops: int | None

    def blocks(self) -> Mapping[str, Blocks]:
        """Return each file as one piece."""
        return {name: (data,) for name, data in self.files.items()}


@dataclass(frozen=True, slots=True, eq=False)
class NewVersion:
    """A map about to be stored."""

    name: str
    content: Storable
    sums: Mapping[str, FileSum]
    metadata: dict[str, Any]
    created_unix_ns: int

    @classmethod
    def of(cls, name: str, content: Storable, metadata: dict[str, Any], created_unix_ns: int) -> "NewVersion":
        """Return a map with the sums of its files, which take a while for a large one."""
        sums = {file: FileSum.of(blocks) for file, blocks in content.blocks().items()}
        return cls(name, content, sums, metadata, created_unix_ns)

    def is_like(self, manifest: Manifest) -> bool:
        """Return whether a version holds this already: the same grid, made of the same."""
        return self.content.digest == manifest.digest and all(
            self.sums.get(file) == manifest.files.get(file) for file in (CELLS, STOPS)
        )

    def files(self, version: int) -> tuple[Mapping[str, Blocks], Manifest]:
        """Return its files by name, the manifest last, and what that says.

        Raises:
            MapError: its metadata could not be read again.
            TypeError: they hold something that JSON cannot.
        """
        it, sums = self.content, dict(self.sums)
        manifest = Manifest(
            *(self.name, version, self.created_unix_ns, it.digest, it.spec, sums, self.metadata, it.stops)
        )
        described = manifest.encode()
        check_readable(self.name, described)
        return {**it.blocks(), MANIFEST: (described,)}, manifest


def read_manifest(path: Path, name: str, version: int) -> Manifest:
    """Return what the manifest in a version's directory says; MapError if it is damaged, or another version's."""
    manifest = decode_manifest(_read(path / MANIFEST, _MANIFEST_MAX_BYTES))
    if (manifest.name, manifest.version) != (name, version):
        raise MapError(f"{MANIFEST} belongs to map {manifest.name} version {manifest.version}")
    return manifest


def read_content(path: Path, manifest: Manifest) -> Content:
    """Return the files in a version's directory, the checksums of all of them right.

    Raises:
        MapError: one is missing or was altered; says which.
    """
    files = {file: b"".join(checked_blocks(path / file, manifest)) for file in files_of(manifest)}
    return Content(manifest.spec, manifest.digest, files, manifest.stops)


def files_of(manifest: Manifest) -> tuple[str, ...]:
    """Return which files a version has, beside its manifest."""
    return (CELLS, IMAGE, YAML, *([] if manifest.stops is None else [STOPS]))


def checked_blocks(path: Path, manifest: Manifest) -> Iterator[bytes]:
    """Yield a file of a version, a mebibyte at a time; only when all was taken it is known to be right.

    Raises:
        MapError: it is missing or was altered; says so.
    """
    expected = manifest.files.get(path.name)
    if expected is None:
        raise MapError(f"{MANIFEST} does not list {path.name}")
    size_bytes, digest = 0, hashlib.sha256()
    for block in _blocks(path, expected.size_bytes):
        size_bytes += len(block)
        digest.update(block)
        yield block
    if size_bytes != expected.size_bytes:
        raise MapError(f"{path.name} has {size_bytes} bytes, expected {expected.size_bytes}")
    if digest.hexdigest() != expected.sha256:
        raise MapError(f"{path.name} was altered: its checksum is wrong")


def check_readable(name: str, described: bytes) -> None:
    """Refuse a manifest that no load could read: what was reported saved must be found."""
    if len(described) > _MANIFEST_MAX_BYTES:
        raise MapError(f"cannot save map {name}: its metadata take more than {_MANIFEST_MAX_BYTES} bytes")
    try:
        decode_manifest(described)
    except MapError as error:
        raise MapError(f"cannot save map {name}: it could not be read again: {error}") from error


def _read(path: Path, max_bytes: int) -> bytes:
    return b"".join(_blocks(path, max_bytes))


def _blocks(path: Path, max_bytes: int) -> Iterator[bytes]:
    left = max_bytes
    try:
        if path.exists() and not path.is_file():
            raise MapError(f"{path.name} is no file")  # and opening a pipe would wait for ever
        with path.open("rb") as file:
            # One more than there may be, to see whether there is more.
            while block := file.read(min(_BLOCK_BYTES, left + 1)):
                left -= len(block)
                if left < 0:
                    raise MapError(f"{path.name} is longer than {max_bytes} bytes")
                yield block
    except FileNotFoundError as error:
        raise MapError(f"{path.name} is missing") from error
    except OSError as error:
        raise MapError(f"{path.name} cannot be read: {error.strerror}") from error
