"""Range readings as a table: ``bearing_deg,range_m,status``, one line a reading, the first line the names."""

import csv
import math
from collections.abc import Iterable

from robotd.exact.beams import Beam, beam
from robotd.exact.rationals import DEFAULT, Arithmetic, rational

_COLUMNS = {"bearing_deg", "range_m"}
_STATUS = {"hit": True, "miss": False}


def beams_of(lines: Iterable[str], arithmetic: Arithmetic = DEFAULT) -> list[Beam]:
    """Return the beams of a table for heading 0; a ``miss`` is an over-range reading, and no status is a hit.

    Ranges are exact decimals; a bearing is taken as the rational direction next to it.

    Raises:
        ValueError: a column is missing, or something in a line is impossible.
    """
    table = csv.DictReader((line for line in lines if line.strip() and line[0] != "#"), skipinitialspace=True)
    try:
        return _beams(table, arithmetic)
    except csv.Error as error:
        raise ValueError(f"not a table: {error}") from error


def _beams(table: "csv.DictReader[str]", arithmetic: Arithmetic) -> list[Beam]:
    missing = sorted(_COLUMNS - set(table.fieldnames or ()))
    if missing:
        raise ValueError(f"no column {', '.join(missing)}")
    beams = [_beam(row, number, arithmetic) for number, row in enumerate(table, 1)]
    if not beams:
        raise ValueError("no readings in it")
    return beams


def _beam(row: dict[str, str], number: int, arithmetic: Arithmetic) -> Beam:
    # csv puts surplus columns under None, and None where there are too few.
    if None in row or None in (row["bearing_deg"], row["range_m"]):
        raise ValueError(f"reading {number}: another number of columns than names")
    status = (row.get("status") or "hit").strip()
    if status not in _STATUS:
        raise ValueError(f"reading {number}: the status is hit or miss, got {status}")
    try:
        # The bearing becomes a float next, so only the range needs the arithmetic that was asked for.
        bearing, reach = rational(row["bearing_deg"]), rational(row["range_m"], arithmetic)
    except ValueError as error:
        raise ValueError(f"reading {number}: {error}") from error
    if reach <= 0:
        raise ValueError(f"reading {number}: range_m must be positive, got {row['range_m']}")
    return beam(math.radians(bearing), reach, is_hit=_STATUS[status])
