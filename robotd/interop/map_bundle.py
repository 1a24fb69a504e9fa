"""A map as files that came together, or go together: a yaml and its picture, a picture alone, or both in a zip."""

import io
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import PurePosixPath

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.core.text import printable
from robotd.grid.occupancy import OccupancyGrid
from robotd.interop.map_server import IMAGE_MAX_BYTES, ImportedMap, export_map, import_map
from robotd.interop.map_server_yaml import YAML_MAX_BYTES, MapServerYaml, decode_map_yaml

_PICTURES = {".pgm", ".png", ".bmp"}
_YAMLS = {".yaml", ".yml"}
_MOST_FILES = 1000
"""In a zip: more are not even looked at."""


def map_of_files(
    files: Mapping[str, bytes], resolution_m: float | None = None, origin_m: tuple[float, float] = (0.0, 0.0)
) -> ImportedMap:
    """Return the map of these files, by name: a yaml and its picture, a picture alone, or a zip that has either.

    Args:
        files: what came.
        resolution_m: of a picture alone, metres per pixel; a yaml says it itself.
        origin_m: of a picture alone, its lower-left corner, map frame.

    Raises:
        MapError: one is missing, there are too many, or they are no map; says which.
    """
    zips = [name for name in files if _ending(name) == ".zip"]
    found = _unzipped(zips[0], files[zips[0]]) if len(files) == len(zips) == 1 else files
    yamls = [name for name in found if _ending(name) in _YAMLS]
    pictures = {PurePosixPath(name).name: name for name in found if _ending(name) in _PICTURES}
    if len(yamls) > 1:
        raise MapError(f"expected one map, got {len(yamls)}: {_named(yamls)}")
    if yamls:
        described = decode_map_yaml(found[yamls[0]])
        picture = pictures.get(PurePosixPath(described.image).name)
        if picture is None:
            raise MapError(f"{_named(yamls)} speaks of the picture {printable(described.image)}, which is not there")
    elif len(pictures) == 1:
        (picture,) = pictures.values()
        described = MapServerYaml.of_picture(picture, resolution_m, origin_m)
    else:
        raise MapError(
            f"expected a yaml and its picture (pgm, png, bmp), a picture alone, or a zip, got {_named(files)}"
        )
    return import_map(described, found[picture])


def bundle_of(name: str, spec: GridSpec, cells: NDArray[np.uint8]) -> bytes:
    """Return a map as a zip of a yaml and a picture that keeps every value of its ``uint8[rows, cols]``."""
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as archive:
        for file, data in files_of(name, spec, cells, "scale").items():
            archive.writestr(zipfile.ZipInfo(file), data)  # of no date: the same map is the same bytes
    return written.getvalue()


def files_of(name: str, spec: GridSpec, cells: NDArray[np.uint8], mode: str) -> dict[str, bytes]:
    """Return a map as a yaml and a picture, by name; ``mode`` as of :func:`.export_map`."""
    return export_map(OccupancyGrid(spec, cells), name, mode)


def _unzipped(name: str, data: bytes) -> dict[str, bytes]:
    """Return what may be a map of the files in a zip; whatever it says of their sizes, no more is unpacked."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            if len(archive.namelist()) > _MOST_FILES:
                raise MapError(f"{_named([name])} has {len(archive.namelist())} files, expected a map")
            inside = [info for info in archive.infolist() if _longest(info.filename) and not info.is_dir()]
            if len(inside) > 2:
                names = _named([info.filename for info in inside])
                raise MapError(f"{_named([name])} has more than a yaml and its picture: {names}")
            return {info.filename: _read(archive, info) for info in inside}
    except (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError, ValueError, OSError) as error:
        raise MapError(f"{_named([name])} is damaged: {printable(str(error))}") from error


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    longest = _longest(info.filename)
    with archive.open(info) as file:
        data = file.read(longest + 1)
    if len(data) > longest:
        raise MapError(f"{_named([info.filename])} is larger than that of any map: more than {longest} bytes")
    return data


def _longest(name: str) -> int:
    """Return how long such a file may be; 0 if it is no part of a map."""
    ending = _ending(name)
    return YAML_MAX_BYTES if ending in _YAMLS else IMAGE_MAX_BYTES if ending in _PICTURES else 0


def _ending(name: str) -> str:
    return PurePosixPath(name).suffix.lower()


def _named(names: "Mapping[str, bytes] | list[str]") -> str:
    return ", ".join(printable(name, 60) for name in list(names)[:3]) or "nothing"
