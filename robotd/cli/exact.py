"""``exact``: localize on a map of polygons without any rounding, as the paper's combinatorial algorithm does."""

import argparse
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robotd.cli.quantities import number, whole
from robotd.cli.terminal import print_json, print_pairs, print_table
from robotd.cli.verb import OK, Verb
from robotd.core.errors import MapError, RobotdError
from robotd.grid.binary import BinaryMap
from robotd.localization.exact.arrangement import Arrangement
from robotd.localization.exact.beams import Beam, theta_slices
from robotd.localization.exact.casting import Outcome, Verdict, cast
from robotd.localization.exact.feasible import PolygonMap, best_rank, ranked
from robotd.localization.exact.formats import FORMATS
from robotd.localization.exact.outlines import outlines
from robotd.localization.exact.planar import PlanarSet
from robotd.localization.exact.points import Point
from robotd.localization.exact.polygons import edge_count
from robotd.localization.exact.rationals import ARITHMETIC, Rational, rational
from robotd.localization.exact.readings import beams_of
from robotd.localization.exact.regions import Region, of_rank, regions
from robotd.localization.exact.smallest_error import smallest_error
from robotd.localization.exact.surds import Number
from robotd.maps.store import MapStore

_LARGEST_ERROR_M = Rational(1)
_WIDTH_M = Rational(1, 1000)


@dataclass(frozen=True, slots=True)
class _Slice:
    """The answer for one heading."""

    heading_deg: float
    ranks: Arrangement
    best: int


def read_map(path: Path) -> PlanarSet:
    """Return the obstacles of a file of polygons, or of a saved map of cells: a directory of the map store.

    Raises:
        MapError: it is neither, or damaged.
    """
    if path.is_dir():
        grid, _ = MapStore(path.parent).load(path.name)
        spec = grid.spec
        corner = rational(repr(spec.origin_x_m)), rational(repr(spec.origin_y_m))
        occupied = BinaryMap.from_grid(grid).occupied
        return outlines(occupied, rational(repr(spec.resolution_m)), x=corner[0], y=corner[1])
    if path.suffix not in FORMATS:
        raise MapError(f"{path}: the ending must be one of {', '.join(FORMATS)}, or it must be a saved map's directory")
    try:
        return FORMATS[path.suffix](path.read_text(encoding="utf-8"))
    except (ValueError, KeyError, TypeError) as error:
        raise MapError(f"{path}: {error}") from error


def read_beams(path: Path) -> list[Beam]:
    """Return the readings of a table.

    Raises:
        RobotdError: something in it is impossible.
    """
    try:
        with path.open(encoding="utf-8") as lines:
            return beams_of(lines)
    except ValueError as error:
        raise RobotdError(f"{path}: {error}") from error


def _exact(arguments: argparse.Namespace) -> int:
    obstacles, beams = read_map(arguments.map), read_beams(arguments.readings)
    headings_deg = _headings_deg(arguments)
    turned = theta_slices(beams, map(math.radians, headings_deg))
    if arguments.smallest_error is not None:
        return _smallest(arguments, obstacles, turned[0])
    if arguments.at is not None:
        return _why(arguments, obstacles, turned[0])
    polygon_map = PolygonMap(obstacles, arguments.eps_m)
    slices = [_slice(polygon_map, beams, heading) for beams, heading in zip(turned, headings_deg, strict=True)]
    best = max(one.best for one in slices)
    least = max(1, best if arguments.least_rank is None else min(arguments.least_rank, best))
    found = [(one.heading_deg, region) for one in slices for region in regions(one.ranks, of_rank(least))]
    found.sort(key=lambda place: -place[1].best_rank)
    summary = {"edges": edge_count(obstacles), "readings": len(beams), "best_rank": best, "numbers": ARITHMETIC}
    _print(arguments, summary, found)
    if arguments.out is not None:
        _draw(arguments.out, obstacles, max(slices, key=lambda one: one.best), least)
    return OK


def _headings_deg(arguments: argparse.Namespace) -> list[float]:
    """Return the headings to look at; one, unless slices of the whole turn are wanted."""
    first: float = arguments.heading_deg
    return [first + 360.0 * number / arguments.headings for number in range(arguments.headings)]


def _slice(polygon_map: PolygonMap, beams: tuple[Beam, ...], heading_deg: float) -> _Slice:
    ranks = ranked(polygon_map, beams)
    return _Slice(heading_deg, ranks, best_rank(ranks))


def _print(arguments: argparse.Namespace, summary: dict[str, Any], found: list[tuple[float, Region]]) -> None:
    if arguments.json:
        print_json({**summary, "regions": [_document(heading, region) for heading, region in found]})
        return
    print_pairs((name.replace("_", " "), value) for name, value in summary.items())
    names = ("rank", "heading deg", "kind", "area m2", "length m", "x m", "y m", "width m", "height m")
    print_table(names, (_row(heading, region) for heading, region in found))


def _row(heading_deg: float, region: Region) -> tuple[str, ...]:
    west, south, east, north = region.box_m
    sizes = (region.area_m2, region.length_m, *region.centre_m, east - west, north - south)
    return (str(region.best_rank), f"{heading_deg:.3f}", region.kind, *(f"{size:.4f}" for size in sizes))


def _document(heading_deg: float, region: Region) -> dict[str, Any]:
    return {
        "rank": region.best_rank,
        "heading_deg": heading_deg,
        "kind": region.kind,
        "area_m2": region.area_m2 if math.isfinite(region.area_m2) else None,
        "length_m": region.length_m,
        "box_m": region.box_m,
        "readings": [bit for bit in range(region.readings.bit_length()) if region.readings >> bit & 1],
    }


def _why(arguments: argparse.Namespace, obstacles: PlanarSet, beams: tuple[Beam, ...]) -> int:
    """Say of every reading whether it holds at a point, and if not why."""
    pose = Point(*arguments.at)
    verdicts = [cast(obstacles, beam, arguments.eps_m, pose) for beam in beams]
    if arguments.json:
        rows = [
            {"outcome": one.outcome, "free_m": _size(one.free_length), "missed_by_m": _size(one.nearest)}
            for one in verdicts
        ]
        print_json({"rank": sum(one.outcome is Outcome.HOLDS for one in verdicts), "readings": rows})
        return OK
    rows_of_text = [(number, beam, one) for number, (beam, one) in enumerate(zip(beams, verdicts, strict=True))]
    print_table(("reading", "length m", "hit", "why"), (_reason(*row) for row in rows_of_text))
    return OK


def _reason(number: int, beam: Beam, verdict: Verdict) -> tuple[str, ...]:
    why = str(verdict.outcome).replace("_", " ")
    if verdict.free_length is not None:
        why = f"{why} after {float(verdict.free_length):.4f} m"
    if verdict.nearest is not None:
        why = f"{why}, {float(verdict.nearest):.4f} m from the next obstacle"
    return str(number), f"{float(beam.length):.4f}", "yes" if beam.is_hit else "no", why


def _size(number: Number | None) -> float | None:
    return None if number is None else float(number)


def _smallest(arguments: argparse.Namespace, obstacles: PlanarSet, beams: tuple[Beam, ...]) -> int:
    bracket = smallest_error(obstacles, beams, share=arguments.smallest_error, largest=_LARGEST_ERROR_M, width=_WIDTH_M)
    if bracket is None:
        raise RobotdError(f"no pose explains so many readings, even with an error radius of {_LARGEST_ERROR_M} m")
    if arguments.json:
        print_json({"above_m": float(bracket.low), "at_most_m": float(bracket.high)})
    else:
        print_pairs([("above [m]", f"{float(bracket.low):.6f}"), ("at most [m]", f"{float(bracket.high):.6f}")])
    return OK


def _draw(file: Path, obstacles: PlanarSet, one: _Slice, least: int) -> None:
    try:
        from robotd.cli.exact_pictures import draw_ranks  # noqa: PLC0415  # matplotlib is an extra
    except ImportError as error:
        raise RobotdError(f"--out needs matplotlib ({error}): install robotd[plots]") from error
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
    parser.add_argument(
        "map", type=Path, metavar="MAP", help=f"polygons ({', '.join(FORMATS)}), or a saved map's directory"
    )
    parser.add_argument(
        "readings", type=Path, metavar="READINGS", help="a table: bearing_deg,range_m,status (hit or miss)"
    )
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
        "--headings", type=whole(1), default=1, metavar="N", help="look at so many headings evenly round (default: 1)"
    )
    parser.add_argument(
        "--least-rank",
        type=whole(1),
        metavar="K",
        help="show all poses that explain so many readings (default: the most)",
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="draw the answer to a PNG")
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
        help="find the smallest eps for which this share of the readings holds somewhere",
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
