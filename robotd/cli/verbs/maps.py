"""``map save``, ``map load``, ``map discard``, ``map list`` and ``map show``."""

import argparse
import shutil
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotd.cli.connection import connect
from robotd.cli.exit_codes import OK
from robotd.cli.outputs import PNG, output_argument
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.quantities import whole
from robotd.cli.show.half_blocks import Ink, can_draw_blocks, draw, shrink
from robotd.cli.show.terminal import out, print_json, print_table
from robotd.cli.verb import Verb
from robotd.cli.verbs import map_changes, map_files, map_making, map_store, stored_stops
from robotd.cli.verbs.map_making import map_name, pose_argument
from robotd.contract.answers import MapEntryInfo
from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import MapChanged
from robotd.contract.topics import Topic
from robotd.core.clock import NS_PER_S
from robotd.core.grid_bytes import grid_digest
from robotd.core.pose import Pose2
from robotd.grid.tables import NO_INFORMATION

if TYPE_CHECKING:
    from robotd.client import Client


_PATIENCE_S = 0.5


def _save(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        return _tell(arguments, "saved", client.map_save(arguments.name))


def _load(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        return _tell(arguments, "loaded", client.map_load(arguments.name, arguments.version, arguments.robot))


def _discard(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        client.map_discard()
    out().print("what was not saved of the map in use was given up")
    return OK


def _tell(arguments: argparse.Namespace, what: str, entry: MapEntryInfo) -> int:
    if arguments.json:
        print_json(asdict(entry))
    else:
        size = f"{entry.cols} x {entry.rows} cells of {entry.resolution_m * 1000:g} mm"
        made = "" if entry.stops is None else f", made of {entry.stops} stops"
        out().print(f"{what} {entry.name} version {_version(entry)}: {size}{made}, digest {entry.digest}")
    return OK


def _list(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        entries = client.map_list()
    if arguments.json:
        print_json([asdict(entry) for entry in entries])
        return OK
    rows = [
        (
            *(
                entry.name,
                _version(entry),
                _date(entry.created_unix_ns),
                f"{entry.cols} x {entry.rows}",
                "-" if entry.stops is None else f"{entry.stops}",
            ),
            f"damaged: {entry.damage}" if entry.damage else entry.digest[:12],
        )
        for entry in entries
    ]
    print_table(("map", "version", "made (UTC)", "cells", "stops", "digest"), rows)
    return OK


def _version(entry: MapEntryInfo) -> str:
    return f"{entry.version} (unsaved)" if entry.unsaved else f"{entry.version}"


def _date(unix_ns: int) -> str:
    return datetime.fromtimestamp(unix_ns // NS_PER_S, UTC).strftime("%Y-%m-%d %H:%M:%S")


def _show(arguments: argparse.Namespace) -> int:
    if arguments.live:
        from robotd.cli.live import live  # noqa: PLC0415  # it needs a terminal, and what handles keys

        return live(arguments, with_map=True)
    if arguments.png is not None:
        require_plots("--png")
    with connect(arguments) as client:
        shown = client.map_show(arguments.name, arguments.version)
        pose = _newest_pose(client, shown.map_id)
    robot = None if pose is None else pose.best
    if arguments.png is not None:
        _draw(arguments.png, f"Map {arguments.name}" if arguments.name else "The map in use", shown, robot)
    if arguments.json:
        print_json(_facts(shown))
        return OK
    columns = min(shutil.get_terminal_size().columns, arguments.width or 100)
    console = out()
    ink = Ink(colour=bool(console.is_terminal and console.color_system), blocks=can_draw_blocks(console.encoding))
    places_m = [] if pose is None or robot is not None else [(one.pose.x_m, one.pose.y_m) for one in pose.regions]
    console.print(draw(shrink(shown.spec, shown.values, columns), ink, robot=robot, places_m=places_m))
    if shown.stops is not None:
        out().print(f"made of {shown.stops} stops")
    return OK


def _newest_pose(client: "Client", map_id: str | None) -> PoseEstimate | None:
    """Return where the robot is believed to be, if that is told, and told of this map."""
    with client.subscribe(Topic.POSE) as events:
        event = events.next(_PATIENCE_S)
    return event if isinstance(event, PoseEstimate) and event.map_id == map_id else None


def _draw(file: Path, title: str, shown: MapChanged, robot: Pose2 | None) -> None:
    from robotd.cli.pictures.rooms import draw_map  # noqa: PLC0415  # only here is the extra needed

    draw_map(file, title, shown.spec, shown.values, robot=robot)


def _facts(shown: MapChanged) -> dict[str, object]:
    values: NDArray[np.uint8] = shown.values
    return {
        "map_id": shown.map_id,
        "generation": shown.generation,
        "digest": grid_digest(shown.spec, values),
        "spec": asdict(shown.spec),
        "stops": shown.stops,
        "free_cells": int((values < NO_INFORMATION).sum()),
        "unknown_cells": int((values == NO_INFORMATION).sum()),
        "occupied_cells": int((values > NO_INFORMATION).sum()),
    }


def _save_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", nargs="?", type=map_name, help="another name than the one it was made under")


def _load_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="the map")
    parser.add_argument("--version", type=whole(0), metavar="N", help="an older version of it (default: the newest)")
    pose_argument(parser, "--robot", "where the robot stands on it, if you know")


def _show_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", nargs="?", help="a stored map (default: the one in use)")
    parser.add_argument("--version", type=whole(0), metavar="N", help="an older version of it (default: the newest)")
    parser.add_argument("--width", type=whole(1), metavar="N", help="widest picture, in characters (default: 100)")
    parser.add_argument("--live", action="store_true", help="show the map in use as it grows, and the robot on it")
    output_argument(parser, "--png", PNG, "draw it into a file, too")


VERBS = (
    *map_making.VERBS,
    Verb("map save", "store the map in use", "robotctl map save", _save, _save_arguments, asks_daemon=True),
    Verb(
        "map load", "take a stored map into use", "robotctl map load kitchen", _load, _load_arguments, asks_daemon=True
    ),
    Verb(
        "map discard",
        "give up what was not saved of the map in use, which then stands in nobody's way",
        "robotctl map discard",
        _discard,
        asks_daemon=True,
    ),
    Verb("map list", "list the stored maps", "robotctl map list", _list, asks_daemon=True),
    Verb(
        "map show",
        "draw a map on the terminal, with its axes in metres and the robot",
        "robotctl map show kitchen --png kitchen.png",
        _show,
        _show_arguments,
        asks_daemon=True,
    ),
    *map_files.VERBS,
    *map_store.VERBS,
    *stored_stops.VERBS,
    *map_changes.VERBS,
)
