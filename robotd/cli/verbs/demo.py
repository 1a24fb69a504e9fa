"""``demo room``, ``demo building``, ``demo console``: what ``make demo``, ``make demo-real``, ``make console`` call."""

import argparse

from robotd.cli.inputs import input_argument
from robotd.cli.logs import LOG_HELP, RAW_HELP, reading_arguments
from robotd.cli.outputs import DEMO, output_argument
from robotd.cli.quantities import positive, whole
from robotd.cli.verb import Verb
from robotd.cli.wheels import odometry_argument


def _room(arguments: argparse.Namespace) -> int:
    from robotd.cli.demo import room  # noqa: PLC0415  # simulation, client and engine, for who wants to see them

    return room.run(arguments)


def _building(arguments: argparse.Namespace) -> int:
    from robotd.cli.demo import real_building  # noqa: PLC0415  # as above

    return real_building.run(arguments)


def _console(arguments: argparse.Namespace) -> int:
    from robotd.cli.demo import console  # noqa: PLC0415  # as above

    return console.run(arguments)


def _room_arguments(parser: argparse.ArgumentParser) -> None:
    """Take the world and where to put the results."""
    parser.add_argument("world", nargs="?", default="laboratory", help="built-in world or TOML file")
    parser.add_argument("--seed", type=whole(0), default=1, metavar="N", help="of the simulated robot (default: 1)")
    parser.add_argument("--localizations", type=whole(1), default=4, metavar="N", help="how many (default: 4)")
    parser.add_argument(
        "--stops",
        type=whole(0),
        default=None,
        metavar="N",
        help="map the first N good places to stop, in place of exploring",
    )
    output_argument(parser, "--out", DEMO, "for the results (default: demo)", default="demo")


def _building_arguments(parser: argparse.ArgumentParser) -> None:
    """Take the log, how much of it, and where to put the results."""
    input_argument(parser, "log", LOG_HELP, metavar="LOG")
    parser.add_argument("--stops", type=whole(1), default=60, metavar="N", help="stops of the map (default: 60)")
    parser.add_argument(
        "--trials", type=whole(0), default=30, metavar="N", help="kept-out stops to visit (default: 30)"
    )
    parser.add_argument("--spacing-m", type=positive, default=1.0, metavar="M", help="between stops (default: 1.0)")
    odometry_argument(parser)
    reading_arguments(parser)
    parser.add_argument("--raw", action="store_true", help=RAW_HELP)
    output_argument(parser, "--out", DEMO, "for the results (default: demo)", default="demo")


def _console_arguments(parser: argparse.ArgumentParser) -> None:
    """Take the world, and where the console shall be."""
    parser.add_argument("world", nargs="?", default="laboratory", help="built-in world or TOML file")
    parser.add_argument("--seed", type=whole(0), default=1, metavar="N", help="of the simulated robot (default: 1)")
    parser.add_argument("--port", type=whole(0), default=8470, metavar="N", help="of the console (default: 8470)")
    output_argument(parser, "--out", DEMO, "for what robot and console make (default: console)", default="console")


VERBS = (
    Verb(
        "demo room",
        "show the main job: a simulated robot maps a room over real serial protocol, and is found in it",
        "robotctl demo room laboratory",
        _room,
        _room_arguments,
    ),
    Verb(
        "demo building",
        "the same in a recorded building: map real stops of a CARMEN log, then be found at those kept out of the map",
        "robotctl demo building intel.corrected.log.gz",
        _building,
        _building_arguments,
    ),
    Verb(
        "demo console",
        "start a simulated robot, the daemon and the console, and print an address for a browser",
        "robotctl demo console laboratory",
        _console,
        _console_arguments,
    ),
)
