"""``map stops``: what a stored map was made of, and by how much its stops correct odometry. It needs no daemon."""

import argparse
import math
from typing import Any

from robotd.cli.exit_codes import OK
from robotd.cli.quantities import whole
from robotd.cli.show.terminal import print_json, print_table
from robotd.cli.verb import Verb
from robotd.cli.verbs.map_store import filled_store_of, store_arguments
from robotd.core.errors import MapError
from robotd.core.map_stop import MapStop


def _stops(arguments: argparse.Namespace) -> int:
    stored = filled_store_of(arguments).load(arguments.name, arguments.version)
    if stored.stops is None:
        raise MapError(
            f"{arguments.name}: it is not known of which stops this map was made: it was imported, or is old"
        )
    stops = stored.stops.stops
    rows = [
        _row(number, before, stop) for number, (before, stop) in enumerate(zip((None, *stops), stops, strict=False))
    ]
    if arguments.json:
        print_json(rows)
        return OK
    print_table(
        ("stop", "x [m]", "y [m]", "heading [deg]", "readings", "at tilts [deg]", "off odometry's step [mm]", "[deg]"),
        (
            (
                *(row["stop"], f"{row['x_m']:.3f}", f"{row['y_m']:.3f}", f"{math.degrees(row['heading_rad']):.1f}"),
                *(row["readings"], ", ".join(f"{math.degrees(tilt_rad):.1f}" for tilt_rad in row["tilts_rad"])),
                *(f"{1000.0 * row['off_m']:.0f}", f"{math.degrees(row['off_rad']):.2f}"),
            )
            for row in rows
        ),
    )
    return OK


def _row(number: int, before: MapStop | None, stop: MapStop) -> dict[str, Any]:
    """Return what is told of a stop; ``off``: how far its step from the one before differs from odometry's."""
    pose, off_m, off_rad = stop.map_from_robot, 0.0, 0.0
    if before is not None:
        step, told = before.map_from_robot.inverse() @ pose, before.in_odom.inverse() @ stop.in_odom
        off = told.inverse() @ step
        off_m, off_rad = math.hypot(off.x_m, off.y_m), off.heading_rad
    return {
        "stop": number,
        "x_m": pose.x_m,
        "y_m": pose.y_m,
        "heading_rad": pose.heading_rad,
        "readings": len(stop.beams(misses=True)),
        "tilts_rad": [slant.tilt.tilt_rad for slant in stop.slants],
        "off_m": off_m,
        "off_rad": off_rad,
    }


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="the map")
    parser.add_argument("--version", type=whole(0), metavar="N", help="an older version of it (default: the newest)")
    store_arguments(parser)


VERBS = (
    Verb(
        "map stops",
        "list the stops that a stored map was made of, and how far each corrects odometry",
        "robotctl map stops kitchen",
        _stops,
        _arguments,
    ),
)
