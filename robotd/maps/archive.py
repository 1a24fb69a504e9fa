"""Versions of maps on disk, as ``root/NAME/VERSION/``, with the files of :mod:`robotd.maps.version_files`.

A version appears whole or not at all and is never changed afterwards; one that is kept *unsaved* loses that mark, in
one step, when it is saved. Loading checks everything and never falls back by itself: a robot that trusts the wrong map
is worse off than one that has none.
"""

import contextlib
import logging
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Generic, TypeVar

from robotd.core.errors import MapError
from robotd.maps.atomic import make_directory, publish_directory, remove_leftover, replace_file, withdraw_directory
from robotd.maps.entry import UNSAVED, MapEntry
from robotd.maps.lock import sole_writer
from robotd.maps.manifest import Manifest, check_name
from robotd.maps.places import check_new_name, directories, leftovers, next_version, temporary_place, versions
from robotd.maps.version_files import (
    MANIFEST,
    Content,
    NewVersion,
    Storable,
    check_readable,
    read_content,
    read_manifest,
)

UNSAVED_KEPT = 3
"""How many such versions of each map are kept; they take no place from the others."""

_log = logging.getLogger(__name__)


T = TypeVar("T")


class Archive(Generic[T]):
    """The maps under one directory. Blocks on the disk: call it on a thread. Writers of any process take turns."""

    def __init__(self, root: Path, read: Callable[[Path, Manifest], T], *, keep: int = 10) -> None:
        """Look at ``root``, which need not exist yet.

        Args:
            root: where the maps are.
            read: returns what a version in a directory holds, its checksums right, or raises MapError.
            keep: how many versions of each map to keep.
        """
        self._root = root
        self._read_version = read
        self._keep = keep
        self._loaded: tuple[str, int] | None = None
        """The version loaded last, which may be the map in use: however old, it is not dropped."""

    @property
    def root(self) -> Path:
        """Where the maps are."""
        return self._root

    def require_writable(self) -> None:
        """Refuse a place for maps where none can be written, before somebody spends an hour on one.

        Raises:
            MapError: says where, and why.
        """
        with _disk_errors(f"no map could be kept in {self._root}"):
            make_directory(self._root)
            with sole_writer(self._root):
                return

    def save(
        self,
        name: str,
        content: Storable,
        metadata: dict[str, Any],
        created_unix_ns: int,
        *,
        in_place_of: tuple[str, int] | None = None,
    ) -> MapEntry:
        """Store a map as a new version, synced to the disk, and drop versions too many.

        What is there already as a version marked :data:`UNSAVED` is not written again: it takes on this metadata.
        Once the map is there, ``in_place_of``, a version marked so that holds no more than this one, goes.

        Raises:
            MapError: the name is no name, another writer would not end, or the disk refused; what was there before
                is untouched.
            TypeError: ``metadata`` holds something that JSON cannot.
        """
        check_name(name)
        # Before the lock: other writers need not wait while this one sums up.
        new = NewVersion.of(name, content, metadata, created_unix_ns)
        with _disk_errors(f"cannot save map {name}"):
            make_directory(self._root)
            with sole_writer(self._root):
                entry = self._save(new)
                if in_place_of is not None and in_place_of != (entry.name, entry.version):
                    self._drop_unsaved(*in_place_of)
                return entry

    def load(self, name: str, version: int | None = None) -> tuple[MapEntry, T]:
        """Return a map, checked byte by byte; the newest version that somebody saved, or else kept, if none is given.

        Raises:
            MapError: there is no such map, or it is damaged; says what is damaged, and which older version is not.
        """
        check_name(name)
        with _disk_errors(f"cannot load map {name}"):
            loaded = self._load_version(name, version)
        self._loaded = (name, loaded[0].version)
        return loaded

    def copy(self, name: str, new_name: str, version: int | None = None) -> MapEntry:
        """Store a version once more under another name, as that map's next version; every byte is checked before.

        Raises:
            MapError: there is no such version, it is damaged, or the new name may not be one.
        """
        entry, _ = self.load(name, version)
        return self.save(new_name, self._read(entry), entry.metadata, entry.created_unix_ns)

    def rename(self, name: str, new_name: str) -> tuple[MapEntry, ...]:
        """Give a map another name: all of its versions, which are numbered from 1 again.

        The old ones go when all new ones are there: whenever the power goes, every version is under one of the names.

        Raises:
            MapError: there is no such map, a version is damaged, the new name is taken or may not be one.
        """
        check_name(name)
        check_name(new_name)
        with _disk_errors(f"cannot rename map {name}"):
            old = self._all_versions(name)
            # One writer from the first look to the last: what was saved in between would go with the old name.
            with sole_writer(self._root):
                check_new_name(new_name, self._names())
                if self._versions(new_name):
                    raise MapError(f"there is a map {new_name!r} already: delete it first, or take another name")
                for version in old:  # all are looked at before the first is written: half a map helps nobody
                    self._load_version(name, version)
                make_directory(self._root / new_name)
                renamed = tuple(self._published(self._under(new_name, name, version)) for version in old)
                self._withdraw(name, old)
        return renamed

    def _under(self, new_name: str, name: str, version: int) -> NewVersion:
        entry, _ = self._load_version(name, version)
        return NewVersion.of(new_name, self._read(entry), entry.metadata, entry.created_unix_ns)

    def _read(self, entry: MapEntry) -> Content:
        return read_content(entry.path, read_manifest(entry.path, entry.name, entry.version))

    def delete(self, name: str, version: int | None = None) -> tuple[int, ...]:
        """Remove a version of a map, or all of it, and return what went; a damaged one goes like any other.

        Raises:
            MapError: there is no such version, another writer would not end, or the disk refused.
        """
        check_name(name)
        with _disk_errors(f"cannot delete map {name}"):
            present = self._all_versions(name)
            if version is not None and version not in present:
                raise MapError(f"map {name} has no version {version}; it has {', '.join(map(str, present))}")
            gone = present if version is None else (version,)
            with sole_writer(self._root):
                self._withdraw(name, gone)
        return gone

    def _withdraw(self, name: str, versions: tuple[int, ...]) -> None:
        for version in versions:
            withdraw_directory(self._root / name / str(version), self._leftover(name, version))
        # What else lies beside the versions is not ours: then the directory stays, and is no map any more.
        with contextlib.suppress(OSError):
            (self._root / name).rmdir()

    def damaged(self, name: str, version: int, error: MapError) -> MapError:
        """Return that a version is damaged, and which other one is not."""
        return MapError(f"map {name} version {version} is damaged: {error}; {self._intact(name, version)}")

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
            yield MapEntry.damaged(name, 0, self._root / name, f"the directory cannot be read: {error.strerror}")
            return
        for version in numbers:
            yield self._listed(name, version)

    def _save(self, new: NewVersion) -> MapEntry:
        name = new.name
        # Under the lock: two writers could each find the name free.
        check_new_name(name, self._names())
        make_directory(self._root / name)
        self._remove_leftovers()
        kept = self._kept_like(new)
        if kept is not None:
            return self._marked(kept, new)
        entry = self._published(new)
        self._prune(name)
        return entry

    def _published(self, new: NewVersion) -> MapEntry:
        """Write a version in the place after the last."""
        name = new.name
        version = next_version(self._root / name)
        files, manifest = new.files(version)
        path = self._root / name / str(version)
        try:
            publish_directory(self._leftover(name, version), path, files)
        except OSError:
            self._remove_leftovers()
            raise
        # A disk that folds capitals, or the like, would have it under another name: then nothing is dropped for it.
        if version not in self._versions(name):
            raise MapError(f"map {name} was written, and {path} is not there: this file system keeps other names")
        return MapEntry.of(manifest, path)

    def _load_version(self, name: str, version: int | None) -> tuple[MapEntry, T]:
        versions = self._all_versions(name)
        # A map of two stops of five, kept by itself, must not take the place of one that somebody saved (decision 25).
        wanted = self._newest(name, versions) if version is None else version
        if wanted not in versions:
            raise MapError(f"map {name} has no version {wanted}; it has {', '.join(map(str, versions))}")
        try:
            return self._load(name, wanted)
        except MapError as error:
            raise self.damaged(name, wanted, error) from error

    def _load(self, name: str, version: int) -> tuple[MapEntry, T]:
        path = self._root / name / str(version)
        manifest = read_manifest(path, name, version)
        return MapEntry.of(manifest, path), self._read_version(path, manifest)

    def _listed(self, name: str, version: int) -> MapEntry:
        path = self._root / name / str(version)
        try:
            return MapEntry.of(read_manifest(path, name, version), path)
        except MapError as error:
            return MapEntry.damaged(name, version, path, str(error))

    def _newest(self, name: str, versions: tuple[int, ...]) -> int:
        saved = (version for version in reversed(versions) if not self._listed(name, version).is_unsaved)
        return next(saved, versions[-1])

    def _kept_like(self, new: NewVersion) -> MapEntry | None:
        """Return the version marked unsaved that is this map, and intact."""
        name = new.name
        for entry in (self._listed(name, version) for version in reversed(self._versions(name))):
            if entry.is_unsaved and entry.digest == new.content.digest:
                with contextlib.suppress(MapError):
                    if new.is_like(read_manifest(entry.path, name, entry.version)):
                        return self._load(name, entry.version)[0]
        return None

    def _marked(self, kept: MapEntry, new: NewVersion) -> MapEntry:
        """Give a version that is kept other metadata, in one step: saving it makes it one like all others."""
        if new.metadata.get(UNSAVED) is True:
            return kept
        manifest = replace(
            read_manifest(kept.path, kept.name, kept.version),
            metadata=new.metadata,
            created_unix_ns=new.created_unix_ns,
        )
        described = manifest.encode()
        check_readable(kept.name, described)
        replace_file(self._leftover(kept.name, kept.version), kept.path / MANIFEST, described)
        self._prune(kept.name)
        return MapEntry.of(manifest, kept.path)

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

    def _all_versions(self, name: str) -> tuple[int, ...]:
        """Return the versions of a map that must be there."""
        versions = self._versions(name)
        if not versions:
            raise MapError(f"there is no map {name!r}; there is {', '.join(self._names()) or 'none at all'}")
        return versions

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
        # Counted apart: maps that kept themselves must not push out what somebody saved.
        for version in (*saved[: -self._keep], *unsaved[:-UNSAVED_KEPT]):
            if (name, version) != self._loaded:
                self._drop(name, version)

    def _drop_unsaved(self, name: str, version: int) -> None:
        if version in self._versions(name) and self._listed(name, version).is_unsaved:
            self._drop(name, version)

    def _drop(self, name: str, version: int) -> None:
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
