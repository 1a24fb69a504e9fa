"""CARMEN log files: real scans of real buildings.

What bites in these files, and what is done about it:

* ``FLASER`` carries the laser's pose; the robot's is that pose moved back by ``robot_frontlaser_offset``.
* In corrected logs (GMapping) the ``odom_*`` of ``FLASER`` only copies the corrected pose, and raw odometry is in
  the ODOM lines (:mod:`robotd.logs.odometry`). Other logs hold raw odometry only (:mod:`robotd.logs.provenance`).
* Ranges at the top of the scale mean *nothing came back* (:mod:`robotd.logs.no_returns`).
* Time stamps run backwards; file order is right. Headings are not wrapped.
* Where each scan is there twice, as ``FLASER`` and as ``ROBOTLASER1``, the former is taken.
* The first beam is at -90 degrees, counter-clockwise, unless something says otherwise (:mod:`robotd.logs.bearings`).
* Lines are cut, torn, or counted wrongly: they are left out, and told by their number.
"""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.logs.bearings import Bearings, bearings_of
from robotd.logs.mount import is_upside_down, mount_of
from robotd.logs.no_returns import code_from_m, code_remark, named_limit_m
from robotd.logs.numbers import DamagedLineError
from robotd.logs.odometry import OdometryTrack, pose_between
from robotd.logs.provenance import Fit, fit_of, lie_on_odometry, moved_to_odometry
from robotd.logs.records import KINDS, RAW_KINDS, LaserRecord, Odom, Parameter, parse_line
from robotd.logs.scan import PoseSource, Problem, RecordedLog, Scan
from robotd.logs.units import refuse_other_units

_PROBLEMS_MAX = 100
_FARTHEST_M = 1e4
"""No scanner measures more: such a number says that nothing came back."""
_NEAREST_M = 0.02
"""No scanner measures less; Hokuyo's write what went wrong as this many millimetres."""


@dataclass(frozen=True, slots=True, eq=False)
class _Placed:
    """A scan and where in the file it stood."""

    record: LaserRecord
    line: int
    odom_lines: int
    """ODOM lines before it."""
    chained: Pose2
    """Odometry so far, chained."""


@dataclass(slots=True)
class _Reader:
    """Collects the records of one log."""

    scans: dict[str, list[_Placed]] = field(default_factory=dict)
    params: dict[str, str] = field(default_factory=dict)
    track: OdometryTrack = field(default_factory=OdometryTrack)
    problems: list[Problem] = field(default_factory=list)
    damaged_lines: int = 0

    def note(self, line: int, message: str) -> None:
        """Note a damaged line; of very many, the first are enough."""
        self.damaged_lines += 1
        if len(self.problems) < _PROBLEMS_MAX:
            self.problems.append(Problem(line, message))

    def take(self, number: int, line: str) -> None:
        """Take one line; a damaged one is noted and left out."""
        try:
            record = parse_line(line)
        except DamagedLineError as error:
            self.note(number, str(error))
            return
        if isinstance(record, Parameter):
            # The last one counts: a setting that was changed is told again.
            self.params[record.name] = record.value
        elif isinstance(record, Odom):
            self.track.take(record)
        elif record is not None:
            self._take_scan(number, record)

    def _take_scan(self, number: int, record: LaserRecord) -> None:
        placed = _Placed(record, number, len(self.track.lines), self.track.chained)
        # By kind, all of them: which is best is known when the file is at its end.
        self.scans.setdefault(record.kind, []).append(placed)
        self.track.pass_scan(record.laser_pose)

    def chosen(self) -> list[_Placed]:
        """Return the scans of the best kind there is, without those that are laid out unlike most of them."""
        for kind in KINDS:
            placed = self.scans.get(kind, [])
            if placed:
                usual = Counter(one.record.layout for one in placed).most_common()
                # The most frequent, of equally frequent ones the longer: a line that lost numbers is shorter
                # than it was.
                layout = max(usual, key=lambda pair: (pair[1], pair[0][1]))[0]
                unusual = [one for one in placed if one.record.layout != layout]
                words = f"{kind}: its end is laid out unlike that of the other lines: numbers are missing, or too many"
                for one in unusual:
                    self.note(one.line, words)
                return [one for one in placed if one.record.layout == layout]
        return []


@dataclass(frozen=True, slots=True)
class _Frame:
    """What holds for all scans of a log."""

    mount: Pose2
    is_corrected: bool
    """Whether GMapping wrote it."""
    is_raw: bool
    """Whether its poses can only be odometry, as the records have none."""


def parse_carmen(lines: Iterable[str], *, file: str = "log", fov_rad: float | None = None) -> RecordedLog:
    """Return the scans of a log given line by line.

    Args:
        lines: the log.
        file: what to call it.
        fov_rad: what the scanner sees, from its first beam to its last; where None the log says it, or it is assumed.

    Raises:
        RecordingError: there is no whole scan in it; names the first line that is damaged, if one is. Or its ranges or
            poses cannot be metres; names the likely unit.
    """
    reader = _Reader()
    for number, line in enumerate(lines, start=1):
        reader.take(number, line)
    placed = reader.chosen()
    if not placed:
        raise RecordingError(f"{file}: {_nothing(reader)}")
    return _log(reader, placed, file, fov_rad)


def _nothing(reader: _Reader) -> str:
    if not reader.problems:
        return "no FLASER, RLASER, ROBOTLASER1 or RAWLASER1 record in it; is this a CARMEN log?"
    count = reader.damaged_lines
    lines = "the only damaged line" if count == 1 else f"the first of {count} damaged lines"
    return f"there is no whole scan in it; {lines} is {reader.problems[0]}"


def _log(reader: _Reader, placed: list[_Placed], file: str, fov_rad: float | None) -> RecordedLog:
    records = [one.record for one in placed]
    kind = records[0].kind
    scanner = "rear" if kind in {"RLASER", "ROBOTLASER2", "RAWLASER2"} else "front"
    frame = _Frame(
        mount=mount_of(records, reader.params, scanner),
        # All scans but one: a log may end between a scan and the line that copies its pose.
        is_corrected=reader.track.copies >= len(placed) - 1 > 0 and bool(reader.track.lines),
        is_raw=kind in RAW_KINDS,
    )
    robots = [_robot_pose(reader, one, frame, file) for one in placed]
    refuse_other_units(file, records, robots)
    for record in records:
        # Before anything is measured by ranges: one such number would be the largest of all.
        record.ranges_m[record.ranges_m > _FARTHEST_M] = math.inf
    limits_m = _limits_m(reader, records, scanner)
    code_m = code_from_m([record.ranges_m for record in records], robots, limits_m)
    bearings = _bearings(reader, records, scanner, fov_rad)
    scans = tuple(
        _scan(one, robot, frame, bearings.get(len(one.record.ranges_m)), min(limit_m, code_m))
        for one, robot, limit_m in zip(placed, robots, limits_m, strict=True)
    )
    poses, why = _provenance(reader, placed, scans, frame)
    assumed = (
        *_assumed(bearings.values()),
        *_steps(records),
        *code_remark(code_m),
        *_flat(records),
        *_flipped(reader, scanner),
    )
    # Found in two passes, line by line and by layout; people look for them from top to bottom.
    problems = tuple(sorted(reader.problems, key=lambda problem: problem.line))
    return RecordedLog(scans, min(code_m, *limits_m), poses, why, problems, reader.damaged_lines, assumed)


def _limits_m(reader: _Reader, records: list[LaserRecord], scanner: str) -> list[float]:
    named_m = named_limit_m(reader.params, scanner)
    return [min(named_m, record.max_range_m) for record in records]


def _robot_pose(reader: _Reader, one: _Placed, frame: _Frame, file: str) -> Pose2:
    """Return where the robot was: as the record says it, by where its laser was, or by the ODOM lines around it."""
    record = one.record
    if record.kind.startswith("ROBOTLASER") and record.robot_pose is not None:
        return record.robot_pose
    if record.laser_pose is not None:
        return record.laser_pose @ frame.mount.inverse()
    robot = pose_between(reader.track.lines, one.odom_lines, record.time_s)
    if robot is None:
        raise RecordingError(f"{file}: {record.kind} has no poses, and there is no ODOM record to take them from")
    return robot


def _bearings(reader: _Reader, records: list[LaserRecord], scanner: str, fov_rad: float | None) -> dict[int, Bearings]:
    """Return how the beams lie of each count of beams whose records do not say it."""
    counts = {len(record.ranges_m) for record in records if record.first_rad is None or fov_rad is not None}
    return {count: bearings_of(count, reader.params, scanner, fov_rad) for count in sorted(counts)}


def _scan(one: _Placed, robot: Pose2, frame: _Frame, bearings: Bearings | None, limit_m: float) -> Scan:
    record = one.record
    told = record.robot_pose if record.laser_pose is not None else robot
    missed = record.ranges_m >= limit_m
    if bearings is None:
        assert record.first_rad is not None
        assert record.step_rad is not None
        angles_rad = record.first_rad + record.step_rad * np.arange(len(record.ranges_m), dtype=np.float64)
    else:
        angles_rad = bearings.angles_rad
    with_own_mount = record.kind.startswith("ROBOTLASER") and record.laser_pose is not None
    return Scan(
        robot_pose=robot,
        robot_from_laser=robot.inverse() @ record.laser_pose
        if with_own_mount and record.laser_pose is not None
        else frame.mount,
        odometry=one.chained @ frame.mount.inverse() if frame.is_corrected or told is None else told,
        angles_rad=angles_rad,
        ranges_m=record.ranges_m,
        hit=(record.ranges_m >= _NEAREST_M) & ~missed & np.isfinite(record.ranges_m),
        missed=missed,
        time_s=record.time_s,
    )


def _provenance(
    reader: _Reader, placed: list[_Placed], scans: tuple[Scan, ...], frame: _Frame
) -> tuple[PoseSource, str]:
    if frame.is_raw:
        return PoseSource.RAW_ODOMETRY, f"{placed[0].record.kind} has none: they are those of the ODOM lines around it"
    if frame.is_corrected:
        return PoseSource.CORRECTED, "an ODOM line after each scan copies its pose, as GMapping does"
    # What the walls say goes before what the odometry lines say: a log may have been corrected and its ODOM
    # lines with it.
    fit = fit_of(scans)
    if fit is Fit.GOOD:
        return PoseSource.LOG, "where the robot came by again, its scans fit each other"
    if fit is Fit.BAD:
        return PoseSource.RAW_ODOMETRY, "where the robot came by again, its scans do not fit each other"
    if _is_odometry(reader.track, placed, scans):
        return PoseSource.RAW_ODOMETRY, "they are those of the ODOM lines around them"
    return PoseSource.LOG, ""


def _is_odometry(track: OdometryTrack, placed: list[_Placed], scans: tuple[Scan, ...]) -> bool:
    if not track.lines:  # all that it has are copies of the poses: without another odometry nothing was corrected
        return track.copies >= len(placed) - 1 > 0
    places, times_s = [one.odom_lines for one in placed], [one.record.time_s for one in placed]
    robots, lasers = [scan.robot_pose for scan in scans], [scan.laser_pose for scan in scans]
    return any(
        lie_on_odometry(poses, places, times_s, track.lines)
        for poses in (robots, moved_to_odometry(lasers, places, times_s, track.lines))
    )


def _assumed(bearings: Iterable[Bearings]) -> tuple[str, ...]:
    words = [f"{one.assumed}; --fov-deg says what it is" for one in bearings if one.assumed]
    return (*words[:3], *([f"and so for {len(words) - 3} other counts of beams"] if len(words) > 3 else []))


def _steps(records: list[LaserRecord]) -> tuple[str, ...]:
    count = sum(record.step_assumed for record in records)
    return (f"{count} scans say that their beams are 0 deg apart: taken to be even over their field of view",) * (
        count > 0
    )


def _flat(records: list[LaserRecord]) -> tuple[str, ...]:
    nothing = all(not ((record.ranges_m > 0.0) & np.isfinite(record.ranges_m)).any() for record in records)
    return ("not one range in it is a distance",) if nothing else ()


def _flipped(reader: _Reader, scanner: str) -> tuple[str, ...]:
    words = (
        "PARAM says that the scanner hangs upside down: its ranges are taken to be turned round already, as CARMEN does"
    )
    return (words,) if is_upside_down(reader.params, scanner) else ()
