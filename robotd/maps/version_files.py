"""The files of one version of a map: ``manifest.json, cells.bin, stops.bin, map.pgm, map.yaml``.

``cells.bin`` is the grid (:mod:`robotd.core.grid_bytes`), ``stops.bin`` what it was made of (not there if that is not
known); ``map.pgm`` and ``map.yaml`` are exports for other programs.
"""

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from robotd.core.errors import MapError
from robotd.core.grid_bytes import cell_bytes, cells_of
from robotd.grid.image import encode_pgm, trinary_from_cells
from robotd.grid.map_stops import MapStops
from robotd.grid.map_yaml import map_yaml
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.maps.atomic import Buffer
from robotd.maps.entry import MapEntry, StoredMap
from robotd.maps.manifest import FileSum, Manifest, decode_manifest
from robotd.maps.stops_file import decode_stops, encode_stops

MANIFEST, CELLS, STOPS, IMAGE, YAML = "manifest.json", "cells.bin", "stops.bin", "map.pgm", "map.yaml"
_MANIFEST_MAX_BYTES = 1 << 20

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class NewVersion:
    """A map about to be stored."""

    name: str
    grid: OccupancyGrid
    digest: str
    metadata: dict[str, Any]
    created_unix_ns: int
    stops: int | None
    stops_bin: bytes | None

    @classmethod
    def of(
        cls, name: str, grid: OccupancyGrid, stops: MapStops | None, metadata: dict[str, Any], created_unix_ns: int
    ) -> Self:
        """Return a map with its stops, if they are known and come to its grid again.

        With others it could not be loaded, and the grid is what the robot goes by: the log says that they are left out.
        """
        packed = None
        if stops is not None:
            try:
                packed = encode_stops(stops)
                _check_derived(stops, grid)
            except MapError as error:
                packed = None
                _log.warning("map %s is saved without its stops: %s", name, error)
        count = len(stops.stops) if stops is not None and packed is not None else None
        return cls(name, grid, grid.digest(), metadata, created_unix_ns, count, packed)

    def is_like(self, manifest: Manifest) -> bool:
        """Return whether a version holds this already: the same grid, made of the same."""
        sums = None if self.stops_bin is None else FileSum.of(self.stops_bin)
        return (self.digest, sums) == (manifest.digest, manifest.files.get(STOPS))

    def files(self, version: int) -> tuple[Mapping[str, Buffer], Manifest]:
        """Return its files by name, the manifest last, and what that says.

        Raises:
            MapError: its metadata could not be read again.
            TypeError: they hold something that JSON cannot.
        """
        files: dict[str, Buffer] = {
            CELLS: cell_bytes(self.grid.cells),
            **({} if self.stops_bin is None else {STOPS: self.stops_bin}),
            IMAGE: encode_pgm(trinary_from_cells(self.grid.cells)),
            YAML: map_yaml(IMAGE, self.grid.spec).encode(),
        }
        sums = {file: FileSum.of(data) for file, data in files.items()}
        manifest = Manifest(
            *(self.name, version, self.created_unix_ns, self.digest, self.grid.spec, sums, self.metadata, self.stops)
        )
        described = manifest.encode()
        check_readable(self.name, described)
        return {**files, MANIFEST: described}, manifest


def read_manifest(path: Path, name: str, version: int) -> Manifest:
    """Return what the manifest in a version's directory says; MapError if it is damaged, or another version's."""
    manifest = decode_manifest(_read(path / MANIFEST, _MANIFEST_MAX_BYTES))
    if (manifest.name, manifest.version) != (name, version):
        raise MapError(f"{MANIFEST} belongs to map {manifest.name} version {manifest.version}")
    return manifest


def read_version(path: Path, name: str, version: int, settings: GridSettings | None) -> StoredMap:
    """Return the version in a directory, every byte checked.

    Args:
        path: the directory.
        name: which map it must be.
        version: which version.
        settings: how further readings change a map that does not say itself how they did so far.

    Raises:
        MapError: it is damaged; says which file.
    """
    manifest = read_manifest(path, name, version)
    wanted = (CELLS, IMAGE, YAML, *([] if manifest.stops is None else [STOPS]))
    files = {file: _read_checked(path / file, manifest.files.get(file)) for file in wanted}
    stops = None if manifest.stops is None else _stops_of(files[STOPS], manifest.stops)
    # A map with stops goes on by the settings that it was made with, or it would not come to its stops again.
    grid = _grid_of(manifest, files[CELLS], settings if stops is None else stops.settings)
    if stops is not None:
        _check_derived(stops, grid)
    return StoredMap(grid, stops, MapEntry.of(manifest, path))


def _stops_of(data: bytes, expected: int) -> MapStops:
    try:
        stops = decode_stops(data)
    except MapError as error:
        raise MapError(f"{STOPS}: {error}") from error
    if len(stops.stops) != expected:
        raise MapError(f"{STOPS} has {len(stops.stops)} stops, {MANIFEST} says {expected}")
    return stops


def _check_derived(stops: MapStops, grid: OccupancyGrid) -> None:
    """Refuse stops that make another grid; if another arithmetic laid them in, the grid stands as it was made."""
    derived = stops.grid_on(grid.spec)
    others = int(np.count_nonzero(derived.cells != grid.cells))
    if not others:
        return
    if stops.is_of_this_arithmetic:
        raise MapError(f"{STOPS} does not make this map: {others} of {grid.cells.size} cells come out otherwise")
    _log.info(
        "this machine's arithmetic would draw %d of %d cells otherwise than that of the map's maker",
        others,
        grid.cells.size,
    )


def _grid_of(manifest: Manifest, data: bytes, settings: GridSettings | None) -> OccupancyGrid:
    try:
        cells = cells_of(data, manifest.spec)
    except ValueError as error:
        raise MapError(f"{CELLS} has {error}") from error
    grid = OccupancyGrid(manifest.spec, cells, settings)
    # The checksums say that no byte was altered; this, that these cells belong to this placement.
    if grid.digest() != manifest.digest:
        raise MapError(f"{MANIFEST} has another digest than the map")
    return grid


def check_readable(name: str, described: bytes) -> None:
    """Refuse a manifest that no load could read: what was reported saved must be found."""
    if len(described) > _MANIFEST_MAX_BYTES:
        raise MapError(f"cannot save map {name}: its metadata take more than {_MANIFEST_MAX_BYTES} bytes")
    try:
        decode_manifest(described)
    except MapError as error:
        raise MapError(f"cannot save map {name}: it could not be read again: {error}") from error


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
            # One more than there may be, to see whether there is more.
            data = file.read(max_bytes + 1)
    except FileNotFoundError as error:
        raise MapError(f"{path.name} is missing") from error
    except OSError as error:
        raise MapError(f"{path.name} cannot be read: {error.strerror}") from error
    if len(data) > max_bytes:
        raise MapError(f"{path.name} is longer than {max_bytes} bytes")
    return data
