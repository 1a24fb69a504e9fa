"""``exact``: localize on a map of polygons without any rounding, as the paper's combinatorial algorithm does."""

import argparse
from dataclasses import dataclass
from pathlib import Path

from robotd.cli.exact_inputs import ExactQuestion, question
from robotd.cli.exit_codes import OK
from robotd.cli.inputs import input_argument
from robotd.cli.outputs import PNG, output_argument
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.quantities import number, positive, whole
from robotd.cli.show.exact_answers import say_smallest_error, say_where, say_why
from robotd.cli.verb import Verb
from robotd.core.errors import RobotdError
from robotd.exact.arrangement import Arrangement, at_least
from robotd.exact.beams import Beam
from robotd.exact.feasible import PolygonMap, best_rank, ranked
from robotd.exact.formats import FORMATS
from robotd.exact.planar import PlanarSet
from robotd.exact.points import Point
from robotd.exact.polygons import edge_count
from robotd.exact.rationals import ARITHMETICS, DEFAULT, Rational, name_of, rational
from robotd.exact.regions import regions


@dataclass(frozen=True, slots=True)
class _Slice:
    """The answer for one heading."""

    heading_deg: float
    ranks: Arrangement
    best: int


def _exact(arguments: argparse.Namespace) -> int:
    _refuse_contradictions(arguments)
    if arguments.out is not None:
        require_plots("--out")
    arithmetic = ARITHMETICS[arguments.arithmetic]
    asked = question(arguments, arithmetic)
    eps = rational(arguments.eps_m, arithmetic)
    if arguments.smallest_error is not None:
        say_smallest_error(asked, rational(arguments.smallest_error, arithmetic), as_json=arguments.json)
    elif arguments.at is not None:
        x, y = (rational(at, arithmetic) for at in arguments.at)
        say_why(asked, eps, Point(x, y), as_json=arguments.json)
    else:
        _where(arguments, asked, eps)
    return OK


def _refuse_contradictions(arguments: argparse.Namespace) -> None:
    if arguments.out is not None and (arguments.at is not None or arguments.smallest_error is not None):
        raise RobotdError("--out draws regions: neither --at nor --smallest-error has any")


def _where(arguments: argparse.Namespace, asked: ExactQuestion, eps: Rational) -> None:
    polygon_map = PolygonMap(asked.obstacles, eps)
    by_heading = zip(asked.headings_deg, asked.slices, strict=True)
    slices = [_slice(polygon_map, beams, heading_deg) for heading_deg, beams in by_heading]
    best = max(one.best for one in slices)
    # A place that explains nothing is everywhere, and no answer.
    least = arguments.least_rank or max(1, best)
    found = [(one.heading_deg, region) for one in slices for region in regions(one.ranks, at_least(least))]
    found.sort(key=lambda place: -place[1].best_rank)
    summary = {
        "edges": edge_count(asked.obstacles),
        "readings": len(asked.slices[0]),
        "best_rank": best,
        "arithmetic": arguments.arithmetic,
    }
    say_where(summary, found, as_json=arguments.json)
    if arguments.out is not None:
        _draw(arguments.out, asked.obstacles, max(slices, key=lambda one: one.best), least)


def _slice(polygon_map: PolygonMap, beams: tuple[Beam, ...], heading_deg: float) -> _Slice:
    ranks = ranked(polygon_map, beams)
    return _Slice(heading_deg, ranks, best_rank(ranks))


def _draw(file: Path, obstacles: PlanarSet, one: _Slice, least: int) -> None:
    from robotd.cli.pictures.exact_sets import draw_ranks  # noqa: PLC0415  # matplotlib is an extra

    draw_ranks(file, f"Where, at heading {one.heading_deg:g} deg", obstacles, one.ranks, least=least)


def _decimal(text: str) -> Rational:
    try:
        return rational(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def _radius(text: str) -> Rational:
    value = _decimal(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"must not be negative, got {text}")
    return value


def _part(text: str) -> Rational:
    value = _decimal(text)
    if not 0 < value <= 1:
        raise argparse.ArgumentTypeError(f"must be more than 0 and at most 1, got {text}")
    return value


def _arguments(parser: argparse.ArgumentParser) -> None:
    input_argument(parser, "map", f"polygons ({', '.join(FORMATS)}), or a saved map's directory", metavar="MAP")
    input_argument(parser, "readings", "a table: bearing_deg,range_m,status (hit or miss)", metavar="READINGS")
    parser.add_argument(
        "--eps-m",
        type=_radius,
        default="0.05",
        metavar="M",
        help="how wrong a range may be [m]; 0 for the paper's exact case (default: 0.05)",
    )
    parser.add_argument(
        "--heading-deg", type=number, default=0.0, metavar="DEG", help="the robot's heading [deg] (default: 0)"
    )
    parser.add_argument(
        "--headings", type=whole(1), default=1, metavar="N", help="look at this many headings evenly round (default: 1)"
    )
    parser.add_argument(
        "--within-deg",
        type=positive,
        metavar="DEG",
        help="spread the headings over no more than this to either side of --heading-deg, ends included",
    )
    parser.add_argument(
        "--least-rank",
        type=whole(1),
        metavar="K",
        help="show all poses that explain this many readings (default: the most)",
    )
    output_argument(parser, "--out", PNG, "draw the answer to a PNG")
    parser.add_argument(
        "--arithmetic",
        choices=tuple(ARITHMETICS),
        default=name_of(DEFAULT),
        help="whose rationals to compute with, of those installed; the answer is the same (default: the fastest)",
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--at",
        type=_decimal,
        nargs=2,
        metavar=("X", "Y"),
        help="say which readings hold at a point [m], and why not the others",
    )
    what.add_argument(
        "--smallest-error",
        type=_part,
        metavar="SHARE",
        help="find the smallest eps for which this share of the readings holds somewhere: "
        "two proved bounds, 1/1024 m apart, for the best heading",
    )


VERBS = (
    Verb(
        "exact",
        "localize on a map of polygons by the exact combinatorial algorithm, without rounding",
        "robotctl exact laboratory.toml readings.csv --eps-m 0.02 --out where.png",
        _exact,
        _arguments,
    ),
)
