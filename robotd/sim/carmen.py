"""CARMEN log files: real scans of real buildings.

One record a line, metres and radians. What bites in these files, and what is done about it:

* ``FLASER`` carries the laser's pose; the robot's is that pose moved back by ``robot_frontlaser_offset``.
* In corrected logs (GMapping) the ``odom_*`` of ``FLASER`` only copies the corrected pose. Each scan is followed by
  an ``ODOM`` that copies it too, and the next ones are raw odometry of the *laser*, begun anew there: the steps
  between the copies are chained back into one path.
* Ranges at the top of the scale mean *nothing came back*. The code differs from log to log, and even within one.
* Time stamps run backwards; file order is right. Times are not even read. Headings are not wrapped.
* Where each scan is there twice, as ``FLASER`` and as ``ROBOTLASER1``, the former is taken.
* The first beam is at -90 degrees, counter-clockwise; the step is 180/n for even n and 180/(n-1) for odd n.
"""

import bz2
import gzip
import math
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO, cast

import numpy as np
from numpy.typing import NDArray

from robotd.core.angles import wrap_rad
from robotd.core.errors import RecordingError
from robotd.core.pose import IDENTITY, Pose2

_CODES_FROM_M = 30.0
_CODE_SPREAD_M = 0.2
_LAYOUTS = {
    "FLASER": "n r_1 .. r_n laser_x laser_y laser_theta odom_x odom_y odom_theta",
    "ROBOTLASER1": "type start fov step max_range accuracy mode n r_1 .. r_n m rem_1 .. rem_m "
    "laser_x laser_y laser_theta robot_x robot_y robot_theta",
    "ODOM": "x y theta",
    "PARAM": "name value",
}
_ROBOTLASER_HEAD = 8
"""Numbers before the ranges of ROBOTLASER1: type, start, field of view, step, max range, accuracy, mode, count."""


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """One turn of the recorded scanner."""

    robot_pose: Pose2
    """The robot's pose as the log has it: corrected, in a corrected log."""
    robot_from_laser: Pose2
    """Where the scanner sits on the robot."""
    odometry: Pose2
    """Raw odometry at the scan; continuous over the log."""
    angles_rad: NDArray[np.float64]
    """Directions of the beams in the laser's frame, ascending, ``float64[n]``."""
    ranges_m: NDArray[np.float64]
    """Ranges ``float64[n]``; they mean something only where ``hit``."""
    hit: NDArray[np.bool_]
    """Where something came back, ``bool[n]``."""
    missed: NDArray[np.bool_]
    """Where nothing came back, ``bool[n]``; neither hit nor missed is a failed measurement."""

    @property
    def laser_pose(self) -> Pose2:
        """Where the scanner was, in the frame of ``robot_pose``."""
        return self.robot_pose @ self.robot_from_laser


@dataclass(frozen=True, slots=True)
class CarmenLog:
    """The scans of a log, in file order."""

    scans: tuple[Scan, ...]
    no_return_from_m: float
    """Ranges from here on meant that nothing came back."""


@dataclass(frozen=True, slots=True, eq=False)
class _RawScan:
    """A scan before it is known which ranges mean nothing, and where the laser sits."""

    laser_pose: Pose2
    robot_pose: Pose2 | None
    odometry: Pose2
    angles_rad: NDArray[np.float64]
    ranges_m: NDArray[np.float64]
    max_range_m: float


@dataclass(slots=True)
class _Reader:
    """Collects the records of one log."""

    scans: list[_RawScan] = field(default_factory=list)
    chained: list[Pose2] = field(default_factory=list)
    params: dict[str, str] = field(default_factory=dict)
    odometry: Pose2 = IDENTITY
    last_odom: Pose2 | None = None
    follows_scan: bool = False
    copies: int = 0

    def take(self, record: str, fields: list[str]) -> None:
        """Take one record apart; unknown ones are none of our business."""
        if record == "PARAM" and len(fields) >= 2:
            self.params[fields[0]] = fields[1]
        elif record == "ODOM":
            self._take_odom(fields)
        elif record == "FLASER":
            self._take_flaser(fields)
        elif record == "ROBOTLASER1":
            self._take_robotlaser(fields)

    def _take_odom(self, fields: list[str]) -> None:
        pose = _pose(fields[:3])
        if self.follows_scan and pose == self.scans[-1].laser_pose:
            self.copies += 1  # in a corrected log no measurement: from here on odometry is told from this pose
        elif self.last_odom is not None:
            self.odometry @= self.last_odom.inverse() @ pose
        else:
            self.odometry = pose
        self.last_odom = pose
        self.follows_scan = False

    def _take_flaser(self, fields: list[str]) -> None:
        ranges_m, rest = _counted(fields)
        angles_rad = _front_angles_rad(len(ranges_m))
        self._add(_RawScan(_pose(rest[:3]), None, _pose(rest[3:6]), angles_rad, ranges_m, math.inf))

    def _take_robotlaser(self, fields: list[str]) -> None:
        _, start_rad, _, step_rad, max_range_m, *_ = map(float, fields[: _ROBOTLASER_HEAD - 1])
        ranges_m, rest = _counted(fields[_ROBOTLASER_HEAD - 1 :])
        _, rest = _counted(rest)
        angles_rad = start_rad + step_rad * np.arange(len(ranges_m), dtype=np.float64)
        laser, robot = _pose(rest[:3]), _pose(rest[3:6])
        self._add(_RawScan(laser, robot, robot, angles_rad, ranges_m, max_range_m))

    def _add(self, scan: _RawScan) -> None:
        self.scans.append(scan)
        self.chained.append(self.odometry)
        self.follows_scan = True

    def finish(self) -> CarmenLog:
        """Return the log, now that all of it is known."""
        no_return_from_m = self._no_return_from_m()
        mount = Pose2(float(self.params.get("robot_frontlaser_offset", "0")), 0.0, 0.0)
        pairs = list(zip(self.scans, self.chained, strict=True))
        pairs = [pair for pair in pairs if pair[0].robot_pose is None] or pairs
        is_corrected = self.copies >= len(pairs) - 1 > 0
        scans = []
        for raw, chained in pairs:
            robot_pose = raw.robot_pose or raw.laser_pose @ mount.inverse()
            missed = raw.ranges_m >= min(no_return_from_m, raw.max_range_m)
            scans.append(
                Scan(
                    robot_pose=robot_pose,
                    robot_from_laser=robot_pose.inverse() @ raw.laser_pose if raw.robot_pose else mount,
                    odometry=chained @ mount.inverse() if is_corrected else raw.odometry,
                    angles_rad=raw.angles_rad,
                    ranges_m=raw.ranges_m,
                    hit=(raw.ranges_m > 0.0) & ~missed,
                    missed=missed,
                )
            )
        return CarmenLog(tuple(scans), no_return_from_m)

    def _no_return_from_m(self) -> float:
        """Return the range from which on nothing came back.

        A log that does not say so itself is believed only below 30 m: what lies within 0.2 m of its largest
        range is a code then, as no such scanner sees a wall there indoors, while codes are very frequent.
        """
        if "robot_front_laser_max" in self.params:
            return float(self.params["robot_front_laser_max"])
        largest_m = max((float(scan.ranges_m.max()) for scan in self.scans), default=0.0)
        return largest_m - _CODE_SPREAD_M if largest_m > _CODES_FROM_M else math.inf


def parse_carmen(lines: Iterable[str], *, file: str = "log") -> CarmenLog:
    """Return the scans of a log given line by line.

    Raises:
        RecordingError: a record is damaged (names the line), or there is no scan at all.
    """
    reader = _Reader()
    for number, line in enumerate(lines, start=1):
        record, *fields = line.split() or ("",)
        try:
            reader.take(record, fields)
        except (ValueError, IndexError) as error:
            layout = f"expected {record} {_LAYOUTS[record]}"
            raise RecordingError(f"{file}:{number}: damaged {record} record: {error}; {layout}") from error
    if not reader.scans:
        raise RecordingError(f"{file}: no FLASER or ROBOTLASER1 record in it; is this a CARMEN log?")
    try:
        return reader.finish()
    except ValueError as error:
        raise RecordingError(f"{file}: damaged PARAM record: {error}") from error


def read_carmen(path: Path) -> CarmenLog:
    """Return the scans of a log file, plain, ``.gz`` or ``.bz2``, whatever its name says.

    Raises:
        RecordingError: the file cannot be read, is cut, or :func:`parse_carmen` objects.
    """
    with _opened(path) as lines:
        return parse_carmen(lines, file=str(path))


@contextmanager
def _opened(path: Path) -> Iterator[Iterable[str]]:
    try:
        with path.open("rb") as file:
            magic = file.read(3)
        with _as_text(path, magic) as lines:
            yield lines
    except (OSError, EOFError, zlib.error) as error:
        raise RecordingError(f"{path}: {error}") from error
    except UnicodeDecodeError as error:
        raise RecordingError(f"{path}: not a text: byte {error.start} is {error.object[error.start]:#04x}") from error


def _as_text(path: Path, magic: bytes) -> TextIO:
    if magic.startswith(b"\x1f\x8b"):
        return cast("TextIO", gzip.open(path, "rt", encoding="ascii"))
    if magic.startswith(b"BZh"):
        return cast("TextIO", bz2.open(path, "rt", encoding="ascii"))
    return path.open(encoding="ascii")


def _counted(fields: list[str]) -> tuple[NDArray[np.float64], list[str]]:
    """Return the numbers announced by the first field, and the fields after them."""
    count = int(fields[0])
    if count < 0 or len(fields) < 1 + count:
        raise ValueError(f"{count} numbers are announced, {len(fields) - 1} follow")
    numbers = np.array([float(text) for text in fields[1 : 1 + count]], dtype=np.float64)
    if not np.all(np.isfinite(numbers)):
        raise ValueError("a number is not finite")
    return numbers, fields[1 + count :]


def _pose(fields: list[str]) -> Pose2:
    x_m, y_m, heading_rad = map(float, fields)
    if not all(map(math.isfinite, (x_m, y_m, heading_rad))):
        raise ValueError("a pose is not finite")
    return Pose2(x_m, y_m, wrap_rad(heading_rad))


def _front_angles_rad(count: int) -> NDArray[np.float64]:
    if count < 2:
        raise ValueError(f"a scan of {count} beams")
    step_rad = math.pi / (count - count % 2)
    return step_rad * np.arange(count, dtype=np.float64) - math.pi / 2
