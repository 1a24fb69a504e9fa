"""Sweeps as a table, a reading a line: what a script of one's own writes, or a spreadsheet.

The first line names the columns, each with its unit: a range (``range_m``; ``cm`` and ``mm``, too), its direction from
where the rangefinder's zero points (``bearing_rad`` or ``angle_deg``), where the robot was (``x_m``, ``y_m``, and
``heading_rad`` or ``heading_deg``), and which sweep it is of (``sweep``, ``stop`` or ``scan``). Words may stand before
a name (``stop_x_cm``), other columns are passed over, and so are comments (``#``). An empty range, or ``nan``, was not
measured; from an infinite one nothing came back.
"""

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from robotd.core.angles import wrap_rad
from robotd.core.errors import RecordingError
from robotd.core.pose import IDENTITY, Pose2
from robotd.logs.no_returns import code_from_m, code_remark
from robotd.logs.numbers import DamagedLineError, number
from robotd.logs.provenance import Fit, fit_of
from robotd.logs.scan import PoseSource, Problem, RecordedLog, Scan

_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "rad": 1.0, "deg": math.pi / 180.0}
_COLUMN = re.compile(r"(?:\w+_)?(?:(range|x|y)_(m|cm|mm)|(bearing|angle|heading|theta)_(rad|deg))$", re.IGNORECASE)
_SWEEP = {"sweep", "stop", "scan"}
_SAME_NAME = {"angle": "bearing", "theta": "heading"}
_FARTHEST_M = 1e4
_PLACE_MAX_M = 1e6
_BEAMS_MAX = 100_000
_FINEST_RAD = 1e-5
_PROBLEMS_MAX = 100


@dataclass(frozen=True, slots=True)
class _Column:
    """Where in a line something stands, and what takes it to metres or radians."""

    at: int
    scale: float


@dataclass(frozen=True, slots=True)
class _Reading:
    """One line of the table: a reading, and where the robot was."""

    line: int
    sweep: str
    pose: Pose2
    bearing_rad: float
    range_m: float
    """``nan`` where nothing was measured, ``inf`` where nothing came back."""


def is_header(line: str) -> bool:
    """Return whether a line is the first one of such a table.

    >>> is_header("stop,stop_x_cm,stop_y_cm,sample,angle_deg,range_cm"), is_header("FLASER 180 1.5 1.5")
    (True, False)
    """
    return "range" in _columns(_fields(line))


def parse_sweeps(lines: Iterable[str], *, file: str = "table") -> RecordedLog:
    """Return the sweeps of a table given line by line.

    Raises:
        RecordingError: a column is missing, or no sweep is whole; names the first line that is damaged, if one is.
    """
    table = _Table(file)
    sweeps = [
        sweep
        # By runs and not by names: the same name may come again later, of another sweep.
        for _, run in groupby(table.readings(lines), key=lambda one: (one.sweep, one.pose))
        for sweep in _one_way(list(run))
    ]
    scans = [scan for sweep in sweeps for scan in table.scan(sweep)]
    if not scans:
        first = f"; the first damaged line is {table.problems[0]}" if table.problems else ""
        raise RecordingError(f"{file}: there is no whole sweep in it, of two readings at least{first}")
    return table.log(scans)


@dataclass(slots=True)
class _Table:
    """A table as far as it is read."""

    file: str
    problems: list[Problem] = field(default_factory=list)
    damaged_lines: int = 0
    has_headings: bool = True

    def readings(self, lines: Iterable[str]) -> Iterator[_Reading]:
        """Yield the readings of the lines that are whole; note the others.

        Raises:
            RecordingError: a column is missing.
        """
        columns: dict[str, _Column] = {}
        for line, fields in _rows(lines):
            if not columns:
                columns = self._checked(_columns(fields))
                continue
            try:
                yield _reading(line, fields, columns)
            except DamagedLineError as error:
                self._note(line, str(error))

    def _checked(self, columns: dict[str, _Column]) -> dict[str, _Column]:
        missing = [name for name in ("range", "bearing", "x", "y") if name not in columns]
        if missing:
            wanted = " and ".join(f"{name}_{'rad' if name == 'bearing' else 'm'}" for name in missing)
            raise RecordingError(
                f"{self.file}: no column names {wanted}; the first line must name range, bearing, x, y"
            )
        self.has_headings = "heading" in columns
        return columns

    def _note(self, line: int, message: str) -> None:
        self.damaged_lines += 1
        if len(self.problems) < _PROBLEMS_MAX:
            self.problems.append(Problem(line, message))

    def scan(self, sweep: Sequence[_Reading]) -> Iterator[tuple[Pose2, NDArray[np.float64], NDArray[np.float64]]]:
        """Yield pose, bearings and ranges of a sweep, counter-clockwise; one that is none is noted."""
        bearings_rad = np.unwrap([one.bearing_rad for one in sweep])
        ranges_m = np.array([one.range_m for one in sweep])
        if bearings_rad[-1] < bearings_rad[0]:
            bearings_rad, ranges_m = bearings_rad[::-1], ranges_m[::-1]
        step_rad = float(np.median(np.diff(bearings_rad)))
        if step_rad < _FINEST_RAD:
            self._note(sweep[0].line, "a sweep whose bearings do not change from reading to reading")
            return
        # Readings that were left out leave gaps of whole steps: they are filled with what was not measured.
        beams = np.rint((bearings_rad - bearings_rad[0]) / step_rad).astype(np.int64)
        if beams[-1] >= _BEAMS_MAX or (np.diff(beams) < 1).any():
            self._note(sweep[0].line, "a sweep whose bearings lie neither evenly nor with gaps of whole steps")
            return
        even_rad = bearings_rad[0] + step_rad * np.arange(beams[-1] + 1)
        filled_m = np.full(len(even_rad), math.nan)
        even_rad[beams], filled_m[beams] = bearings_rad, ranges_m
        yield sweep[0].pose, even_rad, filled_m

    def log(self, scans: Sequence[tuple[Pose2, NDArray[np.float64], NDArray[np.float64]]]) -> RecordedLog:
        """Return what was read as a log."""
        poses, ranges = [pose for pose, _, _ in scans], [ranges_m for _, _, ranges_m in scans]
        code_m = code_from_m(ranges, poses, [math.inf] * len(scans))
        read = tuple(
            Scan(
                robot_pose=pose,
                robot_from_laser=IDENTITY,
                odometry=pose,
                angles_rad=bearings_rad,
                ranges_m=ranges_m,
                hit=(ranges_m > 0.0) & (ranges_m < code_m) & np.isfinite(ranges_m),
                missed=ranges_m >= code_m,
            )
            for pose, bearings_rad, ranges_m in scans
        )
        is_bad = fit_of(read) is Fit.BAD
        source = PoseSource.RAW_ODOMETRY if is_bad else PoseSource.LOG
        why = "where the robot came by again, its sweeps do not fit each other" if is_bad else ""
        facing = () if self.has_headings else ("no column says the heading: taken to be 0 at every stop",)
        return RecordedLog(
            read, code_m, source, why, tuple(self.problems), self.damaged_lines, (*facing, *code_remark(code_m))
        )


def _rows(lines: Iterable[str]) -> Iterator[tuple[int, list[str]]]:
    """Yield the fields of each line with its number; comments and blank lines are passed over."""
    for line, text in enumerate(lines, start=1):
        if text.strip() and not text.startswith("#"):
            yield line, _fields(text)


def _fields(line: str) -> list[str]:
    """Return the fields of a line; quotes may stand round them, as no field that is read has a comma in it."""
    return [text.strip().strip('"') for text in line.split(",")]


def _columns(names: Sequence[str]) -> dict[str, _Column]:
    found: dict[str, _Column] = {}
    for at, text in enumerate(names):
        if text.lower() in _SWEEP:
            found.setdefault("sweep", _Column(at, 1.0))
        elif match := _COLUMN.match(text):
            what, unit = (match[1] or match[3]).lower(), (match[2] or match[4]).lower()
            found.setdefault(_SAME_NAME.get(what, what), _Column(at, _UNITS[unit]))
    return found


def _reading(line: int, fields: Sequence[str], columns: dict[str, _Column]) -> _Reading:
    if len(fields) <= max(column.at for column in columns.values()):
        raise DamagedLineError(f"{len(fields)} fields, fewer than columns")

    def told(name: str) -> float:
        column = columns[name]
        return number(fields[column.at]) * column.scale

    place = (told("x"), told("y"), told("heading") if "heading" in columns else 0.0)
    bearing_rad = told("bearing")
    if not all(math.isfinite(value) and abs(value) <= _PLACE_MAX_M for value in (*place, bearing_rad)):
        raise DamagedLineError("where the robot was, or the bearing, is no finite number below 1e+06")
    range_m = told("range") if fields[columns["range"].at] else math.nan
    sweep = fields[columns["sweep"].at] if "sweep" in columns else ""
    return _Reading(
        line,
        sweep,
        Pose2(place[0], place[1], wrap_rad(place[2])),
        bearing_rad,
        math.inf if range_m > _FARTHEST_M else range_m,
    )


def _one_way(run: list[_Reading]) -> Iterator[list[_Reading]]:
    """Yield the parts of a run in which the rangefinder turns on and on: forth and back are two sweeps."""
    steps_rad = np.diff(np.unwrap([one.bearing_rad for one in run]))
    begun, direction = 0, 0.0
    for at, step_rad in enumerate([*steps_rad.tolist(), math.nan], start=1):
        if math.isnan(step_rad) or step_rad == 0.0 or step_rad * direction < 0.0:
            if at - begun >= 2:
                yield run[begun:at]
            begun, direction = at, 0.0
        else:
            direction = direction or step_rad
