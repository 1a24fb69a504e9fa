"""``import carmen``: a real building to drive in, from somebody's log."""

import argparse
from pathlib import Path

from robotd.cli.exit_codes import OK
from robotd.cli.logs import LOG_HELP, Reading, reading_arguments
from robotd.cli.outputs import RECORDED_BUILDING, output_argument, write
from robotd.cli.quantities import positive, whole
from robotd.cli.show.terminal import command_line, out, print_json
from robotd.cli.verb import Verb
from robotd.sim.buildings.building import RecordedBuilding, encode_recorded_building, select_stops


def _carmen(arguments: argparse.Namespace) -> int:
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


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", type=Path, metavar="LOG", help=LOG_HELP)
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
    reading_arguments(parser)


def _every(text: str) -> int:
    count = whole(0)(text)
    if count == 1:
        raise argparse.ArgumentTypeError(
            "1 would keep every stop out of the map: there would be none; 0 keeps none out"
        )
    return count


VERBS = (
    Verb(
        "import carmen",
        "make a recorded building of a CARMEN log, for robotctl sim",
        "robotctl import carmen intel.log.gz --out intel.building",
        _carmen,
        _arguments,
    ),
)
