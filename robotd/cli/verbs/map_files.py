"""``map import`` and ``map export``: maps of other programs into the store, and out of it. They need no daemon."""

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from robotd.cli.exit_codes import OK
from robotd.cli.inputs import input_argument
from robotd.cli.outputs import Kind, OutputPath, check, output_argument, write
from robotd.cli.quantities import number, positive, whole
from robotd.cli.show.terminal import complain, out, print_json
from robotd.cli.verb import Verb
from robotd.cli.verbs.map_store import filled_store_of, store_arguments, store_of
from robotd.core.errors import MapError, RobotdError
from robotd.maps.manifest import is_name

if TYPE_CHECKING:
    from robotd.interop.map_server import ImportedMap
    from robotd.maps.entry import MapEntry

_MODES = ("trinary", "scale", "raw")
_EXPORT = Kind("a directory for a map of map_server")
_IMAGE = Kind("a PGM or PNG picture", lambda head: head.startswith((b"P5", b"\x89PNG")))
_YAML = Kind("the yaml of a map", lambda head: head.startswith(b"image: "))


def _import(arguments: argparse.Namespace) -> int:
    file: Path = arguments.file
    store = store_of(arguments)
    if arguments.resolution is None and file.suffix.lower() not in {".yaml", ".yml"}:
        raise MapError(f"{file}: a picture says nothing of its size: give the yaml beside it, or --resolution")
    read_map, _ = _interop()
    found = read_map(file, arguments.resolution, tuple(arguments.origin))
    metadata = {"imported_from": file.name, "notes": list(found.notes)}
    entry = store.save(arguments.name or _name_of(file), found.grid, metadata, time.time_ns())
    for note in found.notes:
        complain(f"{file}: {note}")
    _tell(arguments, "imported", entry, str(entry.path), found.notes)
    return OK


def _name_of(file: Path) -> str:
    if not is_name(file.stem):
        raise MapError(f"{file}: {file.stem!r} cannot name a map; choose a name with --name")
    return file.stem


def _export(arguments: argparse.Namespace) -> int:
    _, export_map = _interop()
    stored = filled_store_of(arguments).load(arguments.name, arguments.version)
    entry = stored.entry
    files = export_map(stored.grid, entry.name, arguments.mode)
    directory: OutputPath = arguments.directory
    for name in files:
        # All of them before the first is written: a picture without its yaml is no map.
        check(directory / name, _YAML if name.endswith(".yaml") else _IMAGE)
    for name, content in files.items():
        write(directory / name, content)
    _tell(arguments, "exported", entry, str(directory / f"{entry.name}.yaml"), ())
    return OK


def _tell(arguments: argparse.Namespace, what: str, entry: "MapEntry", place: str, notes: tuple[str, ...]) -> None:
    if entry.spec is None:
        raise MapError(f"map {entry.name}: {entry.damage}")
    rows, cols = entry.spec.shape
    if arguments.json:
        facts = {"name": entry.name, "version": entry.version, "digest": entry.digest, "rows": rows, "cols": cols}
        print_json({**facts, "resolution_m": entry.spec.resolution_m, "place": place, "notes": list(notes)})
        return
    size = f"{cols} x {rows} cells of {entry.spec.resolution_m * 1000:g} mm"
    out().print(f"{what} {entry.name} version {entry.version}: {size}; {place}", markup=False)


def _interop() -> tuple[Callable[..., "ImportedMap"], Callable[..., dict[str, bytes]]]:
    """Return ``read_map`` and ``export_map``, which need an extra."""
    try:
        from robotd.interop.map_server import export_map  # noqa: PLC0415  # only here is the extra needed
        from robotd.interop.read_map import read_map  # noqa: PLC0415  # the same
    except ImportError as error:
        raise RobotdError(
            f"maps of other programs need Pillow and PyYAML ({error}): install the extra interop,"
            " pip install 'robotd[interop]', or pip install -e '.[interop]' in a clone"
        ) from error
    return read_map, export_map


def _import_arguments(parser: argparse.ArgumentParser) -> None:
    input_argument(parser, "file", "the yaml of a map, or a picture alone (pgm, png, bmp)", metavar="FILE")
    parser.add_argument("--name", metavar="NAME", help="what to call it (default: the name of the file)")
    parser.add_argument("--resolution", type=positive, metavar="M", help="of a picture alone: metres per pixel")
    parser.add_argument(
        "--origin",
        nargs=2,
        type=number,
        default=(0.0, 0.0),
        metavar=("X", "Y"),
        help="of a picture alone: its lower-left corner on the map [m] (default: 0 0)",
    )
    store_arguments(parser)


def _export_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", metavar="NAME", help="the map")
    output_argument(parser, "directory", _EXPORT, "where to write NAME.yaml and its picture")
    parser.add_argument("--version", type=whole(0), metavar="N", help="an older version of it (default: the newest)")
    parser.add_argument(
        "--mode",
        choices=_MODES,
        default="trinary",
        help="trinary: three greys, which every program reads; scale: all 256 values; raw: 0 to 100 (default: trinary)",
    )
    store_arguments(parser)


VERBS = (
    Verb(
        "map import",
        "take a map of another program into the store: a yaml of map_server and its picture, or a picture alone",
        "robotctl map import willow.yaml --name willow",
        _import,
        _import_arguments,
    ),
    Verb(
        "map export",
        "write a stored map for other programs: a yaml of map_server and its picture",
        "robotctl map export kitchen exported --mode scale",
        _export,
        _export_arguments,
    ),
)
