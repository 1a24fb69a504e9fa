"""``map changes``: what is gone since, and what has come, between two versions of a stored map. It needs no daemon."""

import argparse
from dataclasses import asdict
from typing import TYPE_CHECKING

from robotd.cli.exit_codes import OK
from robotd.cli.quantities import whole
from robotd.cli.show.terminal import out, print_json, print_table
from robotd.cli.verb import Verb
from robotd.cli.verbs.map_store import filled_store_of, store_arguments
from robotd.core.errors import MapError
from robotd.core.map_stop import MapStop

if TYPE_CHECKING:
    from robotd.maps.store import StoredMap


def _changes(arguments: argparse.Namespace) -> int:
    from robotd.slam.changed_places import changed_places  # noqa: PLC0415  # the engine, for this verb alone

    store = filled_store_of(arguments)
    newer = store.load(arguments.name, arguments.version)
    version = newer.entry.version
    older = store.load(arguments.name, version - 1 if arguments.since is None else arguments.since)
    before, stops = _stops_of(older), _stops_of(newer)
    since = _further(before, stops)
    if since is None:
        raise MapError(
            f"{arguments.name} version {version} does not go on with version {older.entry.version}: it is made of other"
            " stops; a map is gone on with by robotctl map continue, or explore --resume"
        )
    places = changed_places(stops[: len(before)], since, newer.grid.spec)
    if arguments.json:
        print_json([{**asdict(place), "box": place.box._asdict()} for place in places])
        return OK
    if not places:
        out().print(f"nothing changed that two of the {len(since)} stops since have seen")
        return OK
    print_table(
        ("change", "west [m]", "south [m]", "east [m]", "north [m]", "cells"),
        ((place.change, *(f"{edge_m:.2f}" for edge_m in place.box), place.cells) for place in places),
    )
    return OK


def _stops_of(stored: "StoredMap") -> tuple[MapStop, ...]:
    if stored.stops is None:
        entry = stored.entry
        raise MapError(f"{entry.name} version {entry.version}: it is not known of which stops this map was made")
    return stored.stops.stops


def _further(before: tuple[MapStop, ...], stops: tuple[MapStop, ...]) -> tuple[MapStop, ...] | None:
    """Return the stops that came after those before; None if these are no beginning of all."""
    # Where they are may have been corrected since; what was seen there was not.
    same = [one.readings.tobytes() == other.readings.tobytes() for one, other in zip(before, stops, strict=False)]
    return stops[len(before) :] if len(before) <= len(stops) and all(same) else None


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="the map")
    parser.add_argument("--version", type=whole(1), metavar="N", help="the newer version (default: the newest)")
    parser.add_argument("--since", type=whole(1), metavar="N", help="the older version (default: the one before)")
    store_arguments(parser)


VERBS = (
    Verb(
        "map changes",
        "list what is gone, and what has come, since an older version of a map that was gone on with",
        "robotctl map changes kitchen --since 3",
        _changes,
        _arguments,
    ),
)
