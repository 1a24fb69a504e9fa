"""The manifest of a stored map: what it is, where it lies, and the checksum of every file, its own included."""

import hashlib
import json
import re
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, fields
from typing import Any, Self

import msgspec

from robotd.core.errors import MapError
from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec

SCHEMA = 2
_FILE_MAX_BYTES = MAX_SIDE_CELLS**2 + 1024  # an image has a few words before its cells
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


def is_name(name: str) -> bool:
    """Return whether a map may have this name."""
    return _NAME.fullmatch(name) is not None


def check_name(name: str) -> None:
    """Refuse a name that is not also a harmless directory name.

    Raises:
        MapError: it is empty, too long, or holds more than letters, digits, dots, dashes and underscores.
    """
    if not is_name(name):
        raise MapError(
            f"{name!r} cannot name a map: take 1 to 64 letters, digits, '.', '-', '_', the first a letter or a digit"
        )


@dataclass(frozen=True, slots=True)
class FileSum:
    """Size and checksum of one file."""

    size_bytes: int
    sha256: str

    @classmethod
    def of(cls, blocks: Iterable[bytes]) -> Self:
        """Return the sum of a file, given in pieces."""
        size_bytes, digest = 0, hashlib.sha256()
        for block in blocks:
            size_bytes += len(block)
            digest.update(block)
        return cls(size_bytes, digest.hexdigest())


@dataclass(frozen=True, slots=True)
class Manifest:
    """What a map's ``manifest.json`` says."""

    name: str
    version: int
    created_unix_ns: int
    digest: str
    """Of placement and cells, as :meth:`robotd.grid.occupancy.OccupancyGrid.digest` gives it."""
    spec: GridSpec
    files: dict[str, FileSum]
    metadata: dict[str, Any]
    stops: int | None
    """How many stops ``stops.bin`` holds; None if there is no such file."""

    def encode(self) -> bytes:
        """Return the file's bytes.

        Raises:
            TypeError: ``metadata`` holds something that JSON cannot.
        """
        content = {"schema": SCHEMA, **asdict(self)}
        return json.dumps({**content, "sha256": _sum(content)}, indent=1).encode() + b"\n"


def decode_manifest(data: bytes) -> Manifest:
    """Return what a ``manifest.json`` says.

    Raises:
        MapError: it is cut, altered, or of a schema that this version does not know; says which.
    """
    try:
        content = json.loads(data)
        claimed = content.pop("sha256")
        schema = content.pop("schema")
    except KeyError as error:
        raise MapError(f"manifest.json has no {error.args[0]!r}") from error
    except (ValueError, AttributeError, TypeError, RecursionError) as error:
        raise MapError(f"manifest.json is damaged: {error}") from error
    # Not isinstance: JSON's true would pass for schema 1.
    if type(schema) is not int or not (schema == SCHEMA or schema in _MIGRATIONS):
        raise MapError(f"manifest.json has schema {str(schema)[:20]}, this version reads schemas 1 to {SCHEMA}")
    try:
        is_whole = claimed == _sum({"schema": schema, **content})
    except (ValueError, RecursionError) as error:
        raise MapError(f"manifest.json is damaged: {error}") from error
    if not is_whole:
        raise MapError("manifest.json was altered: its own checksum is wrong")
    return _manifest_of(_migrated(content, schema))


def _with_stops_unknown(content: dict[str, Any]) -> dict[str, Any]:
    """Return what schema 2 says of a map of schema 1, which did not keep its stops."""
    if "stops" in content:
        raise MapError("manifest.json makes no sense: schema 1 has no 'stops'")
    return content | {"stops": None}


_MIGRATIONS: dict[int, Callable[[dict[str, Any]], dict[str, Any]]] = {1: _with_stops_unknown}
"""From each schema to the next: what an old manifest says in the words of the new one. Its files are never changed."""


def _migrated(content: dict[str, Any], schema: int) -> dict[str, Any]:
    for number in range(schema, SCHEMA):
        content = _MIGRATIONS[number](content)
    return content


def _manifest_of(content: dict[str, Any]) -> Manifest:
    try:
        manifest = msgspec.convert(content, Manifest)
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        raise MapError(f"manifest.json makes no sense: {str(error)[:200]}") from error
    unknown = content.keys() - {field.name for field in fields(Manifest)}
    if unknown:
        raise MapError(f"manifest.json makes no sense: it has {str(sorted(unknown))[:80]}")
    _check_sizes(manifest)
    return manifest


def _check_sizes(manifest: Manifest) -> None:
    check_name(manifest.name)
    if max(manifest.spec.shape) > MAX_SIDE_CELLS:
        raise MapError(f"manifest.json makes no sense: more than {MAX_SIDE_CELLS} cells along a side")
    if not all(0 <= one.size_bytes <= _FILE_MAX_BYTES for one in manifest.files.values()):
        raise MapError(f"manifest.json makes no sense: expected files of 0 to {_FILE_MAX_BYTES} bytes")
    if manifest.stops is not None and manifest.stops < 0:
        raise MapError(f"manifest.json makes no sense: {manifest.stops} stops")


def _sum(content: dict[str, Any]) -> str:
    # Sorted and without spaces: the sum is of what the file says, however it is laid out.
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(canonical.encode()).hexdigest()
