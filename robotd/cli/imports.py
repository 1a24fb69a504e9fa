"""``import carmen``: a real building to drive in, from somebody's log."""

import argparse
from pathlib import Path

from robotd.cli.quantities import positive, whole
from robotd.cli.terminal import out, print_json
from robotd.cli.verb import OK, Verb
from robotd.sim.building import write_recorded_building


def _carmen(arguments: argparse.Namespace) -> int:
    building = write_recorded_building(
        arguments.log,
        arguments.out,
        spacing_m=arguments.spacing_m,
        keep_out_every=arguments.keep_out_every,
        limit=arguments.limit,
    )
    kept_out = sum(stop.kept_out for stop in building.stops)
    if arguments.json:
        print_json({"file": str(arguments.out), "stops": len(building.stops) - kept_out, "kept_out": kept_out})
    else:
        stops = f"{len(building.stops) - kept_out} stops to map, {kept_out} kept out to localize at"
        out().print(f"{arguments.out}: {stops}; now: robotctl sim {arguments.out}", markup=False)
    return OK


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", type=Path, metavar="LOG", help="a CARMEN log, as it is or compressed (.gz, .bz2)")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="the recorded building")
    parser.add_argument(
        "--spacing-m", type=positive, default=1.0, metavar="M", help="way between two stops (default: 1)"
    )
    parser.add_argument(
        "--keep-out-every",
        type=whole(0),
        default=2,
        metavar="N",
        help="keep every Nth stop out of the map, to localize at; 0 for none (default: 2)",
    )
    parser.add_argument("--limit", type=whole(0), metavar="N", help="end after so many stops")


VERBS = (
    Verb(
        "import carmen",
        "make a recorded building of a CARMEN log, for robotctl sim",
        "robotctl import carmen intel.log.gz --out intel.building",
        _carmen,
        _arguments,
    ),
)
