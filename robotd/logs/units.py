"""Are the ranges of a log metres, and the steps of its robot? Not if its program forgot to divide.

No scanner sees half of all that it tells apart beyond 130 m, and no robot goes 20 m from scan to scan; what was written
in centimetres or millimetres does. It is refused and not divided: which of the two it was can only be guessed.
"""

from collections.abc import Sequence

import numpy as np

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.logs.records import LaserRecord

_RANGE_MAX_M = 130.0
_MILLIMETRES_FROM = 1300.0
"""Where half of all walls lie nearer than 1.3 m, or farther than 13 m, there is no room for a robot with a scanner."""
_VALUES_MIN = 50
"""Different ranges that tell anything: codes count once."""
_STEP_MAX_M = 20.0
_STEPS_MIN = 5
_STILL_M = 0.001


def refuse_other_units(file: str, records: Sequence[LaserRecord], robots: Sequence[Pose2]) -> None:
    """Refuse what cannot be metres.

    Args:
        file: what to call the log.
        records: its scans.
        robots: where the robot was at each.

    Raises:
        RecordingError: the ranges or the poses are no metres; it names the likely unit.
    """
    range_m = _typical_range_m(records)
    if range_m > _RANGE_MAX_M:
        in_mm = range_m >= _MILLIMETRES_FROM
        unit, metres = ("millimetres", range_m / 1000.0) if in_mm else ("centimetres", range_m / 100.0)
        raise RecordingError(
            f"{file}: its ranges cannot be metres, a typical one is {range_m:.0f}; {unit}? then {metres:.2f} m: "
            "divide them and read it again"
        )
    step_m = _typical_step_m(robots)
    if step_m > _STEP_MAX_M:
        raise RecordingError(
            f"{file}: its poses cannot be metres, from scan to scan a typical step is {step_m:.0f}; "
            f"millimetres? then {step_m / 1000.0:.2f} m: divide them and read it again"
        )


def _typical_range_m(records: Sequence[LaserRecord]) -> float:
    told = np.concatenate([record.ranges_m for record in records])
    # Different values and not all of them: a code for nothing came back may be half of a log.
    different = np.unique(told[np.isfinite(told) & (told > 0.0)].round(2))
    return float(np.median(different)) if len(different) >= _VALUES_MIN else 0.0


def _typical_step_m(robots: Sequence[Pose2]) -> float:
    places = np.array([(robot.x_m, robot.y_m) for robot in robots])
    steps_m = np.hypot(*np.diff(places, axis=0).T)
    moved_m = steps_m[steps_m > _STILL_M]
    return float(np.median(moved_m)) if len(moved_m) >= _STEPS_MIN else 0.0
