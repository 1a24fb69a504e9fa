"""The records of a CARMEN log, line by line: one record a line, metres and radians, fields between blanks.

``FLASER`` and ``RLASER`` are the older records of a front and a rear scanner, ``ROBOTLASER1`` and ``2`` the newer
ones, ``RAWLASER1`` to ``5`` what the scanner's driver said before anybody knew where the robot was. The newer ones
are in use with the strengths of the echoes (``m rem_1 .. rem_m``) and without them: the count of fields tells which.
"""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.logs.numbers import DamagedLineError, counted, number, pose

_OLD_TAILS = (9, 7, 6)
"""Fields after the ranges of FLASER: two poses, then time, host and time, or only a time, or nothing."""
_HEAD = 7
"""Numbers before the count of ROBOTLASER1: type, start, field of view, step, max range, accuracy, mode."""
_ROBOT_TAIL = 14
"""Fields after the ranges of ROBOTLASER1: two poses, five numbers, time, host, time."""
_RAW_TAIL = 3
"""Fields after the ranges of RAWLASER1: time, host, time."""
_ROUND_RAD = math.tau + 0.01
_ROUND_DEG = 360.5
_FINEST_RAD = 1e-5
"""No scanner has its beams nearer to each other."""

LAYOUTS = {
    "FLASER": "n r_1 .. r_n laser_x laser_y laser_theta odom_x odom_y odom_theta time host time",
    "ROBOTLASER": "type start fov step max_range accuracy mode n r_1 .. r_n [m rem_1 .. rem_m] "
    "laser_x laser_y laser_theta robot_x robot_y robot_theta tv rv front side axis time host time",
    "RAWLASER": "type start fov step max_range accuracy mode n r_1 .. r_n [m rem_1 .. rem_m] time host time",
    "ODOM": "x y theta tv rv accel time host time",
    "PARAM": "name value",
}


@dataclass(frozen=True, slots=True)
class Parameter:
    """A setting of the programs that wrote the log."""

    name: str
    value: str


@dataclass(frozen=True, slots=True)
class Odom:
    """What the wheels believed."""

    pose: Pose2
    time_s: float | None


@dataclass(frozen=True, slots=True, eq=False)
class LaserRecord:
    """A scan as its line says it."""

    kind: str
    """The first word of the line."""
    layout: tuple[str, int]
    """How the fields after the ranges are laid out: whether echoes are told, and how many fields end the line."""
    ranges_m: NDArray[np.float64]
    """``float64[n]``, at least two; ``nan`` where nothing was measured, ``inf`` where nothing came back."""
    laser_pose: Pose2 | None
    robot_pose: Pose2 | None
    time_s: float | None
    first_rad: float | None = None
    """Direction of the first beam, and from beam to beam; None where the line does not say."""
    step_rad: float | None = None
    max_range_m: float = math.inf
    step_assumed: bool = False
    """Whether the line says that the step is 0, so that it was computed from the field of view."""


_OF_SCANNER = re.compile(
    r"(laser_|robot_)?(front|rear|laser[1-5])_?(laser)?_(\w*offset|fov|resolution|max|max_?range)$"
)
"""The settings that are read as numbers."""
MOUNT_MAX = math.tau
"""No scanner sits farther from the middle of its robot [m], or is turned by more [rad]."""
LINE_MAX = 1 << 20
"""Characters of the longest line that is no damage."""

Record = Parameter | Odom | LaserRecord


def parse_line(line: str) -> Record | None:
    """Return the record of a line; None of a comment, a blank line, or a record of no concern here.

    Raises:
        DamagedLineError: the line is damaged.
    """
    # Before it is split: a file without line ends would become as many texts as it has numbers.
    if len(line) >= LINE_MAX:
        raise DamagedLineError(f"over {LINE_MAX} characters long")
    word, *fields = line.split() or ("",)
    parse = _PARSERS.get(word)
    if parse is not None:
        try:
            return parse(word, fields)
        except DamagedLineError as error:
            raise DamagedLineError(f"{word}: {error}; expected {LAYOUTS[_family(word)]}") from None
    # Told, though it is no record: half of a scan was lost with the line end before it.
    if word[:1] in "+-.0123456789" and word:
        raise DamagedLineError("begins with a number, not with the name of a record: the rest of a torn line?")
    return None


def _family(word: str) -> str:
    return "FLASER" if word == "RLASER" else word.rstrip("12345")


def _parameter(_: str, fields: Sequence[str]) -> Parameter | None:
    if len(fields) < 2:
        return None
    name, value = fields[:2]
    if _OF_SCANNER.match(name) is not None:
        # Read here, though it is used later: the line that holds a text in its place can still be named.
        read = number(value)
        if name.endswith("offset") and not abs(read) <= MOUNT_MAX:
            likely = (
                f"degrees? then {math.radians(read):.3g} rad" if "angular" in name else f"cm? then {read / 100:g} m"
            )
            raise DamagedLineError(f"{value[:20]} is no place of a scanner on a robot; {likely}")
    return Parameter(name, value)


def _odom(_: str, fields: Sequence[str]) -> Odom:
    return Odom(pose(fields), _time_s(fields[6]) if len(fields) > 6 else None)


def _flaser(word: str, fields: Sequence[str]) -> LaserRecord:
    ranges_m, tail = counted(fields)
    if len(tail) not in _OLD_TAILS:
        raise DamagedLineError(f"{len(ranges_m)} ranges are announced, and {len(tail)} fields follow them, not 9")
    laser, odom = pose(tail), pose(tail[3:])
    time_s = _time_s(tail[6]) if len(tail) > 6 else None
    if len(tail) > 6 and time_s is None:
        raise DamagedLineError(f"{tail[6][:20]!r} is no time: a number is missing before it")
    return LaserRecord(word, ("", len(tail)), _several(ranges_m), laser, odom, time_s)


def _robotlaser(word: str, fields: Sequence[str]) -> LaserRecord:
    ranges_m, tail, layout = _new_layout(fields, _ROBOT_TAIL)
    angles = _Angles.of(fields, ranges_m)
    return angles.record(word, layout, (pose(tail), pose(tail[3:])), _time_s(tail[11]))


def _rawlaser(word: str, fields: Sequence[str]) -> LaserRecord:
    ranges_m, tail, layout = _new_layout(fields, _RAW_TAIL)
    return _Angles.of(fields, ranges_m).record(word, layout, (None, None), _time_s(tail[0]))


def _new_layout(fields: Sequence[str], tail_fields: int) -> tuple[NDArray[np.float64], Sequence[str], tuple[str, int]]:
    """Return the ranges, what follows them and their echoes, and which of the two layouts it is."""
    ranges_m, tail = counted(fields[_HEAD:])
    # The shorter layout first: the count of echoes would be read from what is a coordinate here.
    if len(tail) == tail_fields and _time_s(tail[-1]) is not None:
        return ranges_m, tail, ("without echoes", tail_fields)
    _, rest = counted(tail)
    if len(rest) != tail_fields or _time_s(rest[-1]) is None:
        raise DamagedLineError(f"{len(ranges_m)} ranges are announced, and {len(tail)} fields follow them")
    return ranges_m, rest, ("with echoes", tail_fields)


@dataclass(frozen=True, slots=True, eq=False)
class _Angles:
    """What a newer record says of its beams, counter-clockwise."""

    ranges_m: NDArray[np.float64]
    first_rad: float
    step_rad: float
    max_range_m: float
    step_assumed: bool

    @classmethod
    def of(cls, fields: Sequence[str], ranges_m: NDArray[np.float64]) -> "_Angles":
        """Return what the head says: a step of 0 is computed from the field of view, a largest range of 0 is none."""
        _, first_rad, fov_rad, step_rad, max_range_m, *_ = (number(text) for text in fields[:_HEAD])
        count = len(_several(ranges_m))
        step_assumed = step_rad == 0.0
        if step_assumed:
            step_rad = fov_rad / (count - count % 2)
        if not (abs(first_rad) <= _ROUND_RAD and _FINEST_RAD <= abs(step_rad) <= _ROUND_RAD / (count - 1)):
            hint = "; degrees? they must be radians" if _are_degrees(first_rad, step_rad, count) else ""
            beams = f"{count} beams from {first_rad:g} rad on, {step_rad:g} rad apart"
            raise DamagedLineError(f"no scanner has {beams}{hint}")
        if step_rad < 0.0:  # clockwise: the same scan, told from its other end
            first_rad, step_rad, ranges_m = first_rad + step_rad * (count - 1), -step_rad, ranges_m[::-1]
        return cls(ranges_m, first_rad, step_rad, max_range_m if max_range_m > 0.0 else math.inf, step_assumed)

    def record(
        self, word: str, layout: tuple[str, int], poses: tuple[Pose2 | None, Pose2 | None], time_s: float | None
    ) -> LaserRecord:
        """Return the record of which this is the head."""
        return LaserRecord(
            word,
            layout,
            self.ranges_m,
            *poses,
            time_s,
            self.first_rad,
            self.step_rad,
            self.max_range_m,
            self.step_assumed,
        )


def _are_degrees(first: float, step: float, count: int) -> bool:
    return abs(first) <= _ROUND_DEG and abs(step) * (count - 1) <= _ROUND_DEG


def _several(ranges_m: NDArray[np.float64]) -> NDArray[np.float64]:
    if len(ranges_m) < 2:
        raise DamagedLineError(f"a scan of {len(ranges_m)} beams")
    return ranges_m


def _time_s(text: str) -> float | None:
    """Return a time, None if it is none; many logs have useless ones."""
    try:
        time_s = float(text)
    except ValueError:
        return None
    return time_s if math.isfinite(time_s) else None


RAW_KINDS = tuple(f"RAWLASER{number}" for number in range(1, 6))
KINDS = ("FLASER", "ROBOTLASER1", "RLASER", "ROBOTLASER2", *RAW_KINDS)
"""The records of scans; where one scan is told by several of them, or several scanners are, the first here is taken."""
_PARSERS: dict[str, Callable[[str, Sequence[str]], Record | None]] = {
    "PARAM": _parameter,
    "ODOM": _odom,
    "FLASER": _flaser,
    "RLASER": _flaser,
    "ROBOTLASER1": _robotlaser,
    "ROBOTLASER2": _robotlaser,
    **dict.fromkeys(RAW_KINDS, _rawlaser),
}
