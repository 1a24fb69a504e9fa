"""Maps on disk, as ``root/NAME/VERSION/{manifest.json, cells.bin, map.pgm, map.yaml}``.

A version appears whole or not at all and is never changed afterwards; one that is kept *unsaved* loses that mark, in
one step, when it is saved. ``cells.bin`` is the map: the cells row by
row, 8 bits each; ``map.pgm`` and ``map.yaml`` are exports of it for other programs. Loading checks everything and
never falls back by itself: a robot that trusts the wrong map is worse off than one that has none.
"""

import contextlib
import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from robotd.core.errors import MapError
from robotd.core.grid_bytes import cell_bytes, cells_of
from robotd.core.grid_spec import GridSpec
from robotd.grid.image import encode_pgm, trinary_from_cells
from robotd.grid.map_yaml import map_yaml
from robotd.grid.occupancy import GridSettings, OccupancyGrid
from robotd.maps.atomic import (
    Buffer,
    make_directory,
    publish_directory,
    remove_leftover,
    replace_file,
    withdraw_directory,
)
from robotd.maps.lock import sole_writer
from robotd.maps.manifest import FileSum, Manifest, check_name, decode_manifest
from robotd.maps.places import check_new_name, directories, leftovers, next_version, temporary_place, versions

MANIFEST, CELLS, IMAGE, YAML = "manifest.json", "cells.bin", "map.pgm", "map.yaml"
UNSAVED = "unsaved"
"""Key of the metadata that marks a version nobody asked for."""
UNSAVED_KEPT = 3
"""How many such versions of each map are kept; they take no place from the others."""
_MANIFEST_MAX_BYTES = 1 << 20

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class MapEntry:
    """One version of a stored map."""

    name: str
    version: int
    digest: str
    """Of placement and cells: the map's identity. Empty if the manifest is damaged."""
    created_unix_ns: int
    metadata: dict[str, Any]
    path: Path
    """The directory; ``map.yaml`` in it is for other programs."""
    spec: GridSpec | None
    """Its placement; None if the manifest is damaged."""
    damage: str | None = None
    """Why its manifest cannot be read."""

    @property
    def is_unsaved(self) -> bool:
        """Whether nobody asked for it: it was kept so that it is not lost."""
        return self.metadata.get(UNSAVED) is True


class MapStore:
    """The maps under one directory. Blocks on the disk: call it on a thread. Writers of any process take turns."""

    def __init__(self, root: Path, settings: GridSettings | None = None, *, keep: int = 10) -> None:
        """Look at ``root``, which need not exist yet.

        Args:
            root: where the maps are.
            settings: how further readings change a map that was loaded.
            keep: how many versions of each map to keep.
        """
        self._root = root
        self._settings = settings
        self._keep = keep
        self._loaded: tuple[str, int] | None = None

    @property
    def root(self) -> Path:
        """Where the maps are."""
        return self._root

    def save(self, name: str, grid: OccupancyGrid, metadata: dict[str, Any], created_unix_ns: int) -> MapEntry:
        """Store a map as a new version, synced to the disk, and drop versions too many.

        What is there already as a version marked :data:`UNSAVED` is not written again: it takes on this metadata.

        Raises:
            MapError: the name is no name, another writer would not end, or the disk refused; what was there before
                is untouched.
            TypeError: ``metadata`` holds something that JSON cannot.
        """
        check_name(name)
        with _disk_errors(f"cannot save map {name}"):
            make_directory(self._root)
            with sole_writer(self._root):
                return self._save(name, grid, metadata, created_unix_ns)

    def load(self, name: str, version: int | None = None) -> tuple[OccupancyGrid, MapEntry]:
        """Return a map, checked byte by byte; the newest version that somebody saved, or else kept, if none is given.

        Raises:
            MapError: there is no such map, or it is damaged; says what is damaged, and which older version is not.
        """
        check_name(name)
        with _disk_errors(f"cannot load map {name}"):
            loaded = self._load_version(name, version)
        self._loaded = (name, loaded[1].version)
        return loaded

    def list(self) -> tuple[MapEntry, ...]:
        """Return every version of every map by its manifest, oldest first; the files are not checked.

        A map whose directory cannot be read is there as version 0, damaged; what is no map is left out.

        Raises:
            MapError: the store itself cannot be read.
        """
        with _disk_errors("cannot list the maps"):
            return tuple(entry for name in directories(self._root) for entry in self._listed_map(name))

    def _listed_map(self, name: str) -> Iterator[MapEntry]:
        try:
            numbers = self._versions(name)
        except OSError as error:
            yield _damaged(name, 0, self._root / name, f"the directory cannot be read: {error.strerror}")
            return
        for version in numbers:
            yield self._listed(name, version)

    def _save(self, name: str, grid: OccupancyGrid, metadata: dict[str, Any], created_unix_ns: int) -> MapEntry:
        check_new_name(name, self._names())
        make_directory(self._root / name)
        self._remove_leftovers()
        kept = self._kept_like(name, grid.digest())
        if kept is not None:
            return self._marked(kept, metadata, created_unix_ns)
        version = next_version(self._root / name)
        files, manifest = _files_of(name, version, grid, metadata, created_unix_ns)
        path = self._root / name / str(version)
        try:
            publish_directory(self._leftover(name, version), path, files)
        except OSError:
            self._remove_leftovers()
            raise
        if version not in self._versions(name):
            raise MapError(f"map {name} was written, and {path} is not there: this file system keeps other names")
        self._prune(name)
        return _entry_of(manifest, path)

    def _load_version(self, name: str, version: int | None) -> tuple[OccupancyGrid, MapEntry]:
        versions = self._versions(name)
        if not versions:
            raise MapError(f"there is no map {name!r}; there is {', '.join(self._names()) or 'none at all'}")
        wanted = self._newest(name, versions) if version is None else version
        if wanted not in versions:
            raise MapError(f"map {name} has no version {wanted}; it has {', '.join(map(str, versions))}")
        try:
            return self._load(name, wanted)
        except MapError as error:
            raise MapError(f"map {name} version {wanted} is damaged: {error}; {self._intact(name, wanted)}") from error

    def _load(self, name: str, version: int) -> tuple[OccupancyGrid, MapEntry]:
        path = self._root / name / str(version)
        manifest = _read_manifest(path, name, version)
        files = {file: _read_checked(path / file, manifest.files.get(file)) for file in (CELLS, IMAGE, YAML)}
        return _grid_of(manifest, files[CELLS], self._settings), _entry_of(manifest, path)

    def _listed(self, name: str, version: int) -> MapEntry:
        path = self._root / name / str(version)
        try:
            return _entry_of(_read_manifest(path, name, version), path)
        except MapError as error:
            return _damaged(name, version, path, str(error))

    def _newest(self, name: str, versions: tuple[int, ...]) -> int:
        saved = (version for version in reversed(versions) if not self._listed(name, version).is_unsaved)
        return next(saved, versions[-1])

    def _kept_like(self, name: str, digest: str) -> MapEntry | None:
        """Return the version marked unsaved that is this map, and intact."""
        for entry in (self._listed(name, version) for version in reversed(self._versions(name))):
            if entry.is_unsaved and entry.digest == digest:
                with contextlib.suppress(MapError):
                    return self._load(name, entry.version)[1]
        return None

    def _marked(self, kept: MapEntry, metadata: dict[str, Any], created_unix_ns: int) -> MapEntry:
        """Give a version that is kept other metadata, in one step: saving it makes it one like all others."""
        if metadata.get(UNSAVED) is True:
            return kept
        manifest = replace(
            _read_manifest(kept.path, kept.name, kept.version), metadata=metadata, created_unix_ns=created_unix_ns
        )
        replace_file(self._leftover(kept.name, kept.version), kept.path / MANIFEST, manifest.encode())
        self._prune(kept.name)
        return _entry_of(manifest, kept.path)

    def _intact(self, name: str, damaged: int) -> str:
        for version in reversed([version for version in self._versions(name) if version != damaged]):
            with contextlib.suppress(MapError):
                self._load(name, version)
                return f"version {version} is intact"
        return "no other version is intact"

    def _names(self) -> tuple[str, ...]:
        return tuple(name for name in directories(self._root) if self._has_versions(name))

    def _has_versions(self, name: str) -> bool:
        try:
            return bool(self._versions(name))
        except OSError:
            return True  # for all we know

    def _versions(self, name: str) -> tuple[int, ...]:
        return versions(self._root / name)

    def _leftover(self, name: str, version: int) -> Path:
        return temporary_place(self._root, name, version)

    def _remove_leftovers(self) -> None:
        for path in leftovers(self._root):
            remove_leftover(path)

    def _prune(self, name: str) -> None:
        entries = [self._listed(name, version) for version in self._versions(name)]
        saved = [entry.version for entry in entries if not entry.is_unsaved]
        unsaved = [entry.version for entry in entries if entry.is_unsaved]
        for version in (*saved[: -self._keep], *unsaved[:-UNSAVED_KEPT]):
            if (name, version) != self._loaded:
                try:
                    withdraw_directory(self._root / name / str(version), self._leftover(name, version))
                except OSError as error:
                    _log.warning("cannot remove map %s version %d: %s", name, version, error)


@contextlib.contextmanager
def _disk_errors(what: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise MapError(f"{what}: {error.strerror or error}") from error


def _files_of(
    name: str, version: int, grid: OccupancyGrid, metadata: dict[str, Any], created_unix_ns: int
) -> tuple[dict[str, Buffer], Manifest]:
    files: dict[str, Buffer] = {
        CELLS: cell_bytes(grid.cells),
        IMAGE: encode_pgm(trinary_from_cells(grid.cells)),
        YAML: map_yaml(IMAGE, grid.spec).encode(),
    }
    sums = {file: FileSum.of(data) for file, data in files.items()}
    manifest = Manifest(name, version, created_unix_ns, grid.digest(), grid.spec, sums, metadata)
    described = manifest.encode()
    _check_readable(name, described)
    return {**files, MANIFEST: described}, manifest


def _check_readable(name: str, described: bytes) -> None:
    """Refuse a manifest that no load could read: what was reported saved must be found."""
    if len(described) > _MANIFEST_MAX_BYTES:
        raise MapError(f"cannot save map {name}: its metadata take more than {_MANIFEST_MAX_BYTES} bytes")
    try:
        decode_manifest(described)
    except MapError as error:
        raise MapError(f"cannot save map {name}: it could not be read again: {error}") from error


def _damaged(name: str, version: int, path: Path, why: str) -> MapEntry:
    return MapEntry(name, version, "", 0, {}, path, None, damage=why)


def _entry_of(manifest: Manifest, path: Path) -> MapEntry:
    return MapEntry(
        name=manifest.name,
        version=manifest.version,
        digest=manifest.digest,
        created_unix_ns=manifest.created_unix_ns,
        metadata=manifest.metadata,
        path=path,
        spec=manifest.spec,
    )


def _read_manifest(path: Path, name: str, version: int) -> Manifest:
    manifest = decode_manifest(_read(path / MANIFEST, _MANIFEST_MAX_BYTES))
    if (manifest.name, manifest.version) != (name, version):
        raise MapError(f"{MANIFEST} belongs to map {manifest.name} version {manifest.version}")
    return manifest


def _read_checked(path: Path, expected: FileSum | None) -> bytes:
    if expected is None:
        raise MapError(f"{MANIFEST} does not list {path.name}")
    data = _read(path, expected.size_bytes)
    if len(data) != expected.size_bytes:
        raise MapError(f"{path.name} has {len(data)} bytes, expected {expected.size_bytes}")
    if FileSum.of(data) != expected:
        raise MapError(f"{path.name} was altered: its checksum is wrong")
    return data


def _read(path: Path, max_bytes: int) -> bytes:
    try:
        if path.exists() and not path.is_file():
            raise MapError(f"{path.name} is no file")  # and opening a pipe would wait for ever
        with path.open("rb") as file:
            data = file.read(max_bytes + 1)
    except FileNotFoundError as error:
        raise MapError(f"{path.name} is missing") from error
    except OSError as error:
        raise MapError(f"{path.name} cannot be read: {error.strerror}") from error
    if len(data) > max_bytes:
        raise MapError(f"{path.name} is longer than {max_bytes} bytes")
    return data


def _grid_of(manifest: Manifest, data: bytes, settings: GridSettings | None) -> OccupancyGrid:
    try:
        cells = cells_of(data, manifest.spec)
    except ValueError as error:
        raise MapError(f"{CELLS} has {error}") from error
    grid = OccupancyGrid(manifest.spec, cells, settings)
    if grid.digest() != manifest.digest:
        raise MapError(f"{MANIFEST} has another digest than the map")
    return grid
