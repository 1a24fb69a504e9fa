"""Relations: where scans of a log truly lie to each other, checked by hand ([Kuemmerle2009]_), to measure maps by.

A line is ``time_1 time_2 x y z roll pitch yaw``: the robot's pose at the second time in the frame of the first. Times
are those of scans, and are compared to the millisecond. They may run backwards, and several scans may have one: the
first in the file is meant.

.. [Kuemmerle2009] Kuemmerle, Steder, Dornhege, Ruhnke, Grisetti, Stachniss, Kleiner: On Measuring the Accuracy of SLAM
   Algorithms. Autonomous Robots 27, 2009.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from robotd.core.angles import wrap_rad
from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.logs.numbers import DamagedLineError, number
from robotd.logs.scan import Scan

_FIELDS = "time_1 time_2 x y z roll pitch yaw"
_UNKNOWN_MAX_SHARE = 0.01


@dataclass(frozen=True, slots=True)
class Relation:
    """Where the robot was at one scan, as seen from where it was at another; scans count from 0."""

    one: int
    other: int
    step: Pose2


@dataclass(frozen=True, slots=True)
class Relations:
    """All that is known of a log."""

    known: tuple[Relation, ...]
    unknown: int
    """How many speak of times at which the log has no scan."""


def parse_relations(lines: Iterable[str], scans: Sequence[Scan], file: str = "relations") -> Relations:
    """Return the relations between the scans of a log.

    Raises:
        RecordingError: a line is damaged, there is no relation, or more than one in a hundred is of unknown times.
    """
    at: dict[int, int] = {}
    for index, scan in enumerate(scans):
        if scan.time_s is not None:
            # Of several scans of one time the first in the file is meant.
            at.setdefault(_ms(scan.time_s), index)
    known: list[Relation] = []
    unknown = 0
    for line_number, line in enumerate(lines, start=1):
        fields = line.split()
        if not fields or fields[0].startswith("#"):
            continue
        one_s, other_s, step = _parsed(fields, f"{file}:{line_number}")
        one, other = at.get(_ms(one_s)), at.get(_ms(other_s))
        if one is None or other is None:
            unknown += 1
        else:
            known.append(Relation(one, other, step))
    total = len(known) + unknown
    if not total:
        raise RecordingError(f"{file}: no relation in it; expected lines of {_FIELDS}")
    # A few may be of scans that were damaged; more, and the file belongs to another log.
    if unknown > _UNKNOWN_MAX_SHARE * total:
        raise RecordingError(
            f"{file}: {unknown} of {total} relations are of times at which the log has no scan; is it another log's?"
        )
    return Relations(tuple(known), unknown)


def _parsed(fields: Sequence[str], where: str) -> tuple[float, float, Pose2]:
    if len(fields) != len(_FIELDS.split()):
        raise RecordingError(f"{where}: {len(fields)} fields; expected {_FIELDS}")
    try:
        numbers = [number(field) for field in fields]
    except DamagedLineError as error:
        raise RecordingError(f"{where}: {error}; expected {_FIELDS}") from error
    if not all(map(math.isfinite, numbers)):
        raise RecordingError(f"{where}: not all of it is finite; expected {_FIELDS}")
    one_s, other_s, x_m, y_m, _, _, _, yaw_rad = numbers
    return one_s, other_s, Pose2(x_m, y_m, wrap_rad(yaw_rad))


def _ms(time_s: float) -> int:
    return round(time_s * 1000.0)
