"""``map copy``, ``rename``, ``delete`` and ``compare``: stored maps rearranged and looked at. They need no daemon."""

import argparse
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from robotd.cli.exit_codes import FAILED, OK
from robotd.cli.outputs import PNG, output_argument
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.quantities import whole
from robotd.cli.show.terminal import complain, out, print_json, print_table
from robotd.cli.verb import Verb
from robotd.core.errors import ConfigError, MapError

if TYPE_CHECKING:
    import numpy as np

    from robotd.grid.map_comparison import MapComparison
    from robotd.maps.entry import MapEntry
    from robotd.maps.store import MapStore

_KINDS = ("free", "unknown", "occupied")


def store_of(arguments: argparse.Namespace) -> "MapStore":
    """Return the store that ``--maps`` or the configuration names."""
    from robotd import config  # noqa: PLC0415  # it knows every dialect, and most verbs of maps ask a daemon
    from robotd.maps.store import MapStore  # noqa: PLC0415  # it knows the engine, and as above

    if arguments.maps is not None:
        return MapStore(arguments.maps)
    file = arguments.config or config.default_path()
    try:
        tree = config.load(file)
    except ConfigError:
        if arguments.config is not None or file.exists():
            raise
        tree = config.Config()  # nothing was configured here, so a daemon would keep its maps where the default says
    return MapStore(Path(tree.maps.dir), tree.grid, keep=tree.maps.keep)


def filled_store_of(arguments: argparse.Namespace) -> "MapStore":
    """Return the store that is named, for a verb that wants a map of it.

    Raises:
        MapError: there is none, so likely another place was meant.
    """
    store = store_of(arguments)
    if not store.list():
        raise MapError(f"{store.root}: there are no maps; say where they are, with --config FILE or --maps DIR")
    return store


def store_arguments(parser: argparse.ArgumentParser) -> None:
    """Take what :func:`store_of` needs."""
    parser.add_argument("--config", type=Path, metavar="FILE", help="a configuration of the daemon: where maps are")
    parser.add_argument("--maps", type=Path, metavar="DIR", help="where maps are, whatever the configuration says")


def _copy(arguments: argparse.Namespace) -> int:
    entry = filled_store_of(arguments).copy(arguments.name, arguments.new_name, arguments.version)
    return _tell(arguments, f"copied {arguments.name}", (entry,))


def _rename(arguments: argparse.Namespace) -> int:
    entries = filled_store_of(arguments).rename(arguments.name, arguments.new_name)
    return _tell(arguments, f"renamed {arguments.name}", entries)


def _tell(arguments: argparse.Namespace, what: str, entries: "tuple[MapEntry, ...]") -> int:
    if arguments.json:
        print_json([{"name": entry.name, "version": entry.version, "digest": entry.digest} for entry in entries])
        return OK
    versions = ", ".join(str(entry.version) for entry in entries)
    out().print(f"{what}: {entries[0].name} version {versions}", markup=False)
    return OK


def _delete(arguments: argparse.Namespace) -> int:
    if not (arguments.yes or _typed_again(arguments.name)):
        complain(f"nothing was deleted: type the name of the map, {arguments.name}, or give --yes")
        return FAILED
    gone = filled_store_of(arguments).delete(arguments.name, arguments.version)
    if arguments.json:
        print_json({"name": arguments.name, "versions": list(gone)})
    else:
        out().print(f"deleted {arguments.name} version {', '.join(map(str, gone))}", markup=False)
    return OK


def _typed_again(name: str) -> bool:
    """Ask for the name: a slip of the shell's history must not cost a map."""
    # A script cannot be asked, and says --yes.
    return sys.stdin.isatty() and input(f"type {name} to delete it: ").strip() == name


def _compare(arguments: argparse.Namespace) -> int:
    if arguments.png is not None:
        require_plots("--png")
    store = filled_store_of(arguments)
    first, second = (store.load(*_version_of(text)) for text in (arguments.first, arguments.second))
    from robotd.grid.map_comparison import compare_maps  # noqa: PLC0415  # the engine, for this verb alone

    found = compare_maps(first.grid, second.grid)
    if arguments.png is not None:
        from robotd.cli.pictures.compared_maps import draw_comparison  # noqa: PLC0415  # only here is the extra needed

        draw_comparison(arguments.png, f"{arguments.first} and {arguments.second}", found)
    figures = _figures(found)
    if arguments.json:
        print_json({**figures, "counts": found.counts.tolist(), "kinds": list(_KINDS)})
        return OK
    rows = [(kind, *map(str, counts)) for kind, counts in zip(_KINDS, found.counts.tolist(), strict=True)]
    print_table((f"{arguments.first} \\ {arguments.second}", *_KINDS), rows)
    for name, value in figures.items():
        out().print(f"{name.replace('_', ' ')}: {_shown(value)}", markup=False)
    return OK


def _version_of(text: str) -> tuple[str, int | None]:
    """Split ``NAME@VERSION``."""
    name, at, version = text.partition("@")
    if at and not version.isdecimal():
        raise ConfigError(f"{text}: expected NAME or NAME@VERSION, as lab@3")
    return name, int(version) if at else None


def _figures(found: "MapComparison") -> dict[str, float | None]:
    return {
        "agreement_where_both_have_seen": found.agreement,
        "median_way_to_the_other_wall_m": _middle(found.first_walls_off_m),
        "nine_in_ten_walls_within_m": _middle(found.first_walls_off_m, 0.9),
        "back_median_way_m": _middle(found.second_walls_off_m),
        "back_nine_in_ten_walls_within_m": _middle(found.second_walls_off_m, 0.9),
    }


def _middle(off_m: "np.ndarray[tuple[int], np.dtype[np.float64]]", share: float = 0.5) -> float | None:
    if not len(off_m) or not math.isfinite(off_m[int(share * (len(off_m) - 1))]):
        return None
    return float(off_m[int(share * (len(off_m) - 1))])


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _names(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", metavar="NAME", help="the map")
    parser.add_argument("new_name", metavar="NEW", help="the other name")


def _copy_arguments(parser: argparse.ArgumentParser) -> None:
    _names(parser)
    _version_argument(parser, "this version (default: the newest)")
    store_arguments(parser)


def _rename_arguments(parser: argparse.ArgumentParser) -> None:
    _names(parser)
    store_arguments(parser)


def _delete_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", metavar="NAME", help="the map")
    _version_argument(parser, "this version alone (default: all of it)")
    parser.add_argument("--yes", action="store_true", help="do not ask for the name again")
    store_arguments(parser)


def _version_argument(parser: argparse.ArgumentParser, summary: str) -> None:
    parser.add_argument("--version", type=whole(1), metavar="N", help=summary)


def _compare_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("first", metavar="A", help="a stored map, or NAME@VERSION of an older one")
    parser.add_argument("second", metavar="B", help="another, in the same frame")
    output_argument(parser, "--png", PNG, "draw both into one picture, too")
    store_arguments(parser)


VERBS = (
    Verb(
        "map copy",
        "store a map once more under another name",
        "robotctl map copy kitchen kitchen-before-moving",
        _copy,
        _copy_arguments,
    ),
    Verb(
        "map rename",
        "give a stored map another name, with all of its versions",
        "robotctl map rename map1 kitchen",
        _rename,
        _rename_arguments,
    ),
    Verb(
        "map delete",
        "delete a stored map, or one version of it, for good",
        "robotctl map delete map1 --version 2 --yes",
        _delete,
        _delete_arguments,
    ),
    Verb(
        "map compare",
        "lay one stored map on another: where they agree, and how far their walls are apart",
        "robotctl map compare kitchen@3 kitchen --png compared.png",
        _compare,
        _compare_arguments,
    ),
)
