"""Where the emulated robot really stood, from the side channel that no daemon reads."""

import json
from pathlib import Path

from robotd.core.errors import RobotdError
from robotd.core.pose import Pose2


def true_pose(file: Path, time_ns: int) -> Pose2:
    """Return where the robot stood at a time, by the last rest noted before it.

    Raises:
        RobotdError: nothing was noted before.
    """
    before = true_way(file, time_ns)
    if not before:
        raise RobotdError(f"{file} says nothing before {time_ns} ns")
    return before[-1]


def true_way(file: Path, until_ns: int) -> tuple[Pose2, ...]:
    """Return where the robot stood, one rest after the other, up to a time: it goes straight from each to the next."""
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    return tuple(Pose2(line["x_m"], line["y_m"], line["heading_rad"]) for line in lines if line["t_ns"] <= until_ns)
