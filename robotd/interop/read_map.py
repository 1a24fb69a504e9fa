"""A map of another program from disk: the yaml and the picture that it names, or a picture alone."""

from pathlib import Path

from robotd.core.errors import MapError
from robotd.interop.map_server import IMAGE_MAX_BYTES, ImportedMap, import_map
from robotd.interop.map_server_yaml import YAML_MAX_BYTES, MapServerYaml, decode_map_yaml


def read_map(file: Path, resolution_m: float | None = None, origin_m: tuple[float, float] = (0.0, 0.0)) -> ImportedMap:
    """Return a map of map_server.

    Args:
        file: the yaml, or a picture alone.
        resolution_m: of a picture alone, metres per pixel; a yaml says it itself.
        origin_m: of a picture alone, its lower-left corner, map frame.

    Raises:
        MapError: a file cannot be read, or is no such map; names it and what was expected.
    """
    try:
        if file.suffix.lower() in {".yaml", ".yml"}:
            described = decode_map_yaml(_bytes(file, YAML_MAX_BYTES, "it"))
            picture = file.parent / described.image
        else:
            described, picture = MapServerYaml.of_picture(file.name, resolution_m, origin_m), file
        return import_map(described, _bytes(picture, IMAGE_MAX_BYTES, "it" if picture == file else picture.name))
    except MapError as error:
        raise MapError(f"{file}: {error}") from error


def _bytes(file: Path, most: int, name: str) -> bytes:
    try:
        if file.exists() and not file.is_file():
            raise MapError(f"{name} is no file")
        with file.open("rb") as opened:
            return opened.read(most + 1)  # one more than may be: its reader says that it is too long
    except OSError as error:
        raise MapError(f"{name} cannot be read: {error.strerror or error}") from error
