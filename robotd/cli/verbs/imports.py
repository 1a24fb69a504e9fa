"""``import carmen``, ``bag`` and ``csv``: a real building to drive in, from somebody's log."""

import argparse
from collections.abc import Callable

from robotd.cli.exit_codes import OK
from robotd.cli.inputs import input_argument
from robotd.cli.logs import Reading, fov_argument, range_max_argument, scan_topic_argument
from robotd.cli.outputs import RECORDED_BUILDING, output_argument, write
from robotd.cli.quantities import positive, whole
from robotd.cli.show.terminal import command_line, out, print_json
from robotd.cli.verb import Verb
from robotd.sim.buildings.building import RecordedBuilding, encode_recorded_building, select_stops


def _import(arguments: argparse.Namespace) -> int:
    log = Reading.of(arguments).read(arguments.log)
    stops = select_stops(log, arguments.spacing_m, keep_out_every=arguments.keep_out_every, limit=arguments.limit)
    write(arguments.out, encode_recorded_building(RecordedBuilding(arguments.log.name, stops)))
    kept_out = sum(stop.kept_out for stop in stops)
    if arguments.json:
        facts = {"stops": len(stops) - kept_out, "kept_out": kept_out}
        print_json({"file": str(arguments.out), **facts, "poses": log.poses.value, "damaged_lines": log.damaged_lines})
    else:
        words = f"{len(stops) - kept_out} stops to map, {kept_out} kept out to localize at"
        out().print(f"{arguments.out}: {words}; now: {command_line('robotctl', 'sim', arguments.out)}")
    return OK


def _carmen_arguments(parser: argparse.ArgumentParser) -> None:
    _arguments(parser, "a CARMEN log, as it is or packed (.gz, .bz2, .xz); - is standard input")
    fov_argument(parser)


def _bag_arguments(parser: argparse.ArgumentParser) -> None:
    _arguments(parser, "a bag of ROS 1 (.bag), or of ROS 2 (its directory, or a .mcap or .db3 alone)")
    scan_topic_argument(parser)


def _csv_arguments(parser: argparse.ArgumentParser) -> None:
    columns = "sweep, x_m, y_m, heading_rad, bearing_rad, range_m"
    _arguments(
        parser, f"a table with a reading a line, its first line names the columns: {columns}; - is standard input"
    )


def _arguments(parser: argparse.ArgumentParser, what: str) -> None:
    input_argument(parser, "log", what, metavar="LOG")
    output_argument(parser, "--out", RECORDED_BUILDING, "the recorded building", required=True)
    parser.add_argument(
        "--spacing-m", type=positive, default=1.0, metavar="M", help="way between two stops (default: 1)"
    )
    parser.add_argument(
        "--keep-out-every",
        type=_every,
        default=2,
        metavar="N",
        help="keep every Nth stop out of the map, to localize at; 0 for none (default: 2)",
    )
    parser.add_argument("--limit", type=whole(1), metavar="N", help="end after N stops")
    range_max_argument(parser)


def _every(text: str) -> int:
    count = whole(0)(text)
    if count == 1:
        raise argparse.ArgumentTypeError(
            "1 would keep every stop out of the map: there would be none; 0 keeps none out"
        )
    return count


def _row(kind: str, what: str, log: str, arguments: Callable[[argparse.ArgumentParser], None]) -> Verb:
    example = command_line("robotctl", "import", kind, log, "--out", "lab.building")
    return Verb(f"import {kind}", f"make a recorded building of {what}, for robotctl sim", example, _import, arguments)


VERBS = (
    _row("carmen", "a CARMEN log", "lab.log.gz", _carmen_arguments),
    _row("bag", "a bag of ROS", "lab.bag", _bag_arguments),
    _row("csv", "a table of sweeps", "lab.csv", _csv_arguments),
)
