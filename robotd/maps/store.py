"""The store of maps, for programs that have grids at hand."""

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.maps.archive import Archive
from robotd.maps.entry import MapEntry
from robotd.maps.grid_files import content_of, map_of
from robotd.maps.manifest import check_name
from robotd.maps.version_files import read_content

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class StoredMap:
    """A map from the store, whole."""

    grid: OccupancyGrid
    stops: MapStops | None
    """What the grid was made of; None for maps of before stops were stored, and of other origin."""
    entry: MapEntry


class MapStore:
    """The maps under one directory. Blocks on the disk: call it on a thread. Writers of any process take turns."""

    def __init__(self, root: Path, settings: GridSettings | None = None, *, keep: int = 10) -> None:
        """Look at ``root``, which need not exist yet.

        Args:
            root: where the maps are.
            settings: how further readings change a map that was loaded.
            keep: how many versions of each map to keep.
        """
        self._archive = Archive(root, lambda path, manifest: map_of(read_content(path, manifest), settings), keep=keep)

    @property
    def root(self) -> Path:
        """Where the maps are."""
        return self._archive.root

    def save(
        self,
        name: str,
        grid: OccupancyGrid,
        metadata: dict[str, Any],
        created_unix_ns: int,
        stops: MapStops | None = None,
        *,
        in_place_of: tuple[str, int] | None = None,
    ) -> MapEntry:
        """Store a map with the stops that it was made of; see :meth:`.Archive.save`.

        Stops that do not come to its grid again are left out: the log says so.
        """
        check_name(name)
        content, why = content_of(grid, stops)
        if why is not None:
            _log.warning("map %s is saved without its stops: %s", name, why)
        return self._archive.save(name, content, metadata, created_unix_ns, in_place_of=in_place_of)

    def load(self, name: str, version: int | None = None) -> StoredMap:
        """Return a map, everything checked; see :meth:`.Archive.load`."""
        entry, (grid, stops) = self._archive.load(name, version)
        return StoredMap(grid, stops, entry)

    def list(self) -> tuple[MapEntry, ...]:
        """Return every version of every map by its manifest, oldest first; see :meth:`.Archive.list`."""
        return self._archive.list()

    def copy(self, name: str, new_name: str, version: int | None = None) -> MapEntry:
        """Store a version once more under another name; see :meth:`.Archive.copy`."""
        return self._archive.copy(name, new_name, version)

    def rename(self, name: str, new_name: str) -> tuple[MapEntry, ...]:
        """Give a map another name; see :meth:`.Archive.rename`."""
        return self._archive.rename(name, new_name)

    def delete(self, name: str, version: int | None = None) -> tuple[int, ...]:
        """Remove a version of a map, or all of it; see :meth:`.Archive.delete`."""
        return self._archive.delete(name, version)
