"""What ``robotctl exact`` is given: a map, a table of readings, and the headings to look at."""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from robotd.core.errors import MapError, RobotdError
from robotd.exact.beams import Beam, theta_slices
from robotd.exact.formats import FORMATS
from robotd.exact.outlines import outlines
from robotd.exact.planar import PlanarSet
from robotd.exact.rationals import DEFAULT, Arithmetic, rational
from robotd.exact.readings_table import beams_of
from robotd.grid.binary import BinaryMap
from robotd.maps.store import MapStore
from robotd.maps.version_files import MANIFEST


@dataclass(frozen=True, slots=True)
class ExactQuestion:
    """A map, and the readings as they are for each heading."""

    obstacles: PlanarSet
    headings_deg: Sequence[float]
    slices: Sequence[tuple[Beam, ...]]
    arithmetic: Arithmetic


def question(arguments: argparse.Namespace, arithmetic: Arithmetic) -> ExactQuestion:
    """Read what the command line names."""
    obstacles, beams = read_map(arguments.map, arithmetic), read_beams(arguments.readings, arithmetic)
    headings_deg = headings(arguments.heading_deg, arguments.headings, arguments.within_deg)
    return ExactQuestion(obstacles, headings_deg, theta_slices(beams, map(math.radians, headings_deg)), arithmetic)


def headings(prior_deg: float, count: int, within_deg: float | None) -> list[float]:
    """Return the headings to look at: evenly round, or from end to end of what lies near the prior.

    >>> headings(90.0, 4, None), headings(90.0, 3, 2.0), headings(90.0, 1, 2.0)
    ([90.0, 180.0, 270.0, 360.0], [88.0, 90.0, 92.0], [90.0])
    """
    if within_deg is None:
        return [prior_deg + 360.0 * number / count for number in range(count)]
    if count == 1:
        return [prior_deg]
    return [prior_deg + within_deg * (2.0 * number / (count - 1) - 1.0) for number in range(count)]


def read_map(path: Path, arithmetic: Arithmetic = DEFAULT) -> PlanarSet:
    """Return the obstacles of a file of polygons, or of a saved map of cells: a directory of the map store.

    Raises:
        MapError: it is neither, or damaged.
    """
    if path.is_dir():
        return _read_cells(path, arithmetic)
    read = FORMATS.get(path.suffix.lower())
    if read is None:
        raise MapError(f"{path}: the ending must be one of {', '.join(FORMATS)}, or it must be a saved map's directory")
    try:
        return read(path.read_text(encoding="utf-8-sig"), arithmetic)
    except KeyError as error:
        raise MapError(f"{path}: no {error.args[0]} where there must be one") from error
    except (AttributeError, IndexError, TypeError) as error:
        raise MapError(f"{path}: not built as such a file is ({error})") from error
    except (ValueError, RecursionError) as error:
        raise MapError(f"{path}: {error}") from error


def _read_cells(path: Path, arithmetic: Arithmetic) -> PlanarSet:
    path = path.resolve()  # even "." has a name
    if (path / MANIFEST).exists() and path.name.isdecimal():
        grid = MapStore(path.parent.parent).load(path.parent.name, int(path.name)).grid
    elif any(entry.name.isdecimal() for entry in path.iterdir()):
        grid = MapStore(path.parent).load(path.name).grid
    else:
        raise MapError(f"{path}: no saved map: neither its directory nor that of one of its versions{_maps_in(path)}")
    spec = grid.spec
    x, y, cell = (rational(repr(size), arithmetic) for size in (spec.origin_x_m, spec.origin_y_m, spec.resolution_m))
    return outlines(BinaryMap.from_grid(grid).occupied, cell, x=x, y=y)


def _maps_in(path: Path) -> str:
    """Return in words which maps a directory holds, if it holds any."""
    try:
        names = sorted({entry.name for entry in MapStore(path).list()})
    except MapError:
        return ""
    return f"; it holds {', '.join(names)}: name one of them" if names else ""


def read_beams(path: Path, arithmetic: Arithmetic = DEFAULT) -> list[Beam]:
    """Return the readings of a table.

    Raises:
        RobotdError: something in it is impossible.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as lines:
            return beams_of(lines, arithmetic)
    except ValueError as error:
        raise RobotdError(f"{path}: {error}") from error
