"""What ``robotctl exact`` answers, as text or JSON: regions, why readings hold or not, the smallest error radius."""

import math
from collections.abc import Sequence
from typing import Any

from robotd.cli.exact_inputs import ExactQuestion
from robotd.cli.show.terminal import print_json, print_pairs, print_table
from robotd.core.errors import RobotdError
from robotd.exact.beams import Beam
from robotd.exact.casting import CastOutcome, CastVerdict, cast
from robotd.exact.error_bracket import smallest_error
from robotd.exact.points import Point
from robotd.exact.rationals import Rational, rational
from robotd.exact.regions import ExactRegion
from robotd.exact.surds import Number

Place = tuple[float, ExactRegion]
"""A heading [deg] and a region of poses of that heading."""


def say_where(summary: dict[str, Any], found: Sequence[Place], *, as_json: bool) -> None:
    """Say in which regions the readings can have been taken."""
    if as_json:
        print_json({**summary, "regions": [_document(heading, region) for heading, region in found]})
        return
    print_pairs((name.replace("_", " "), value) for name, value in summary.items())
    names = ("rank", "heading deg", "kind", "area m2", "length m", "x m", "y m", "width m", "height m")
    print_table(names, (_row(heading, region) for heading, region in found))


def _row(heading_deg: float, region: ExactRegion) -> tuple[str, ...]:
    west, south, east, north = region.box_m
    sizes = (region.length_m, *region.centre_m, east - west, north - south)
    texts = (f"{size:.4f}" if math.isfinite(size) else "-" for size in sizes)
    return (str(region.best_rank), f"{heading_deg:.3f}", region.kind, f"{region.area_m2:.6g}", *texts)


def _document(heading_deg: float, region: ExactRegion) -> dict[str, Any]:
    return {
        "rank": region.best_rank,
        "heading_deg": heading_deg,
        "kind": region.kind,
        "area_m2": region.area_m2 if math.isfinite(region.area_m2) else None,
        "length_m": region.length_m,
        "box_m": [edge if math.isfinite(edge) else None for edge in region.box_m],
        "readings": [bit for bit in range(region.readings.bit_length()) if region.readings >> bit & 1],
    }


def say_why(asked: ExactQuestion, eps: Rational, pose: Point, *, as_json: bool) -> None:
    """Say of every reading whether it holds at a point, and if not why: at each heading, best first."""
    by_heading = []
    for heading_deg, beams in zip(asked.headings_deg, asked.slices, strict=True):
        verdicts = [cast(asked.obstacles, beam, eps, pose) for beam in beams]
        rank = sum(one.outcome is CastOutcome.HOLDS for one in verdicts)
        by_heading.append((rank, heading_deg, beams, verdicts))
    by_heading.sort(key=lambda one: -one[0])
    if as_json:
        slices = [
            {"heading_deg": heading_deg, "rank": rank, "readings": [_verdict(one) for one in verdicts]}
            for rank, heading_deg, _, verdicts in by_heading
        ]
        print_json({"headings": slices})
        return
    rank, heading_deg, beams, verdicts = by_heading[0]
    if len(by_heading) > 1:
        print_table(("rank", "heading deg"), ((str(one[0]), f"{one[1]:.3f}") for one in by_heading))
    print_pairs([("heading", f"{heading_deg:.3f} deg"), ("rank", f"{rank} of {len(beams)}")])
    rows = zip(beams, verdicts, strict=True)
    print_table(("reading", "length m", "hit", "why"), (_reason(number, *row) for number, row in enumerate(rows)))


def _verdict(one: CastVerdict) -> dict[str, Any]:
    return {"outcome": one.outcome, "free_m": _size(one.free_length), "missed_by_m": _size(one.nearest)}


def _reason(number: int, beam: Beam, verdict: CastVerdict) -> tuple[str, ...]:
    why = str(verdict.outcome).replace("_", " ")
    if verdict.free_length is not None:
        why = f"{why} after {float(verdict.free_length):.4f} m"
    if verdict.nearest is not None:
        why = f"{why}, {float(verdict.nearest):.4f} m from the next obstacle"
    return str(number), f"{float(beam.length):.4f}", "yes" if beam.is_hit else "no", why


def _size(number: Number | None) -> float | None:
    return None if number is None else float(number)


_LARGEST_ERROR_M = 1
_HALVINGS = 10
"""The ends of the bracket are multiples of 2^-10 m, which ten decimals write without rounding."""


def say_smallest_error(asked: ExactQuestion, share: Rational, *, as_json: bool) -> None:
    """Say between which radii the smallest one lies, for the best of the headings.

    Raises:
        RobotdError: no radius up to a metre is enough.
    """
    largest = rational(_LARGEST_ERROR_M, asked.arithmetic)
    width = largest / 2**_HALVINGS
    bracket = smallest_error(asked.obstacles, asked.slices, share=share, largest=largest, width=width)
    if bracket is None:
        raise RobotdError(f"no pose explains this many readings, even with an error radius of {_LARGEST_ERROR_M} m")
    low, high = float(bracket.low), float(bracket.high)
    enough_deg = [asked.headings_deg[number] for number in bracket.slices]
    if as_json:
        print_json({"above_m": low, "at_most_m": high, "needed": bracket.needed, "headings_deg": enough_deg})
        return
    exact = bracket.low == bracket.high
    lines = [
        ("readings needed", f"{bracket.needed} of {len(asked.slices[0])}"),
        ("too small", "nothing is" if exact else f"{low:.10f} m, proved: nowhere do this many hold"),
        ("enough", f"{high:.10f} m, proved: somewhere they do"),
        ("at headings", ", ".join(f"{heading:.3f} deg" for heading in enough_deg)),
    ]
    print_pairs(lines)
