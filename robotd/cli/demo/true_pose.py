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
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    before = [line for line in lines if line["t_ns"] <= time_ns]
    if not before:
        raise RobotdError(f"{file} says nothing before {time_ns} ns")
    last = before[-1]
    return Pose2(last["x_m"], last["y_m"], last["heading_rad"])
