"""Where the robot really stood: a side channel for demonstrations, which no daemon reads."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from robotd.core.pose import Pose2
from robotd.sim.hosting.pace import Time
from robotd.sim.robot import EmulatedRobot


class TruthLog:
    """Appends one JSON line whenever the robot has come to rest somewhere else."""

    def __init__(self, robot: EmulatedRobot, time: Time, file: TextIO) -> None:
        self._robot = robot
        self._time = time
        self._file = file
        self._told: Pose2 | None = None

    def note(self) -> None:
        """Look at the robot, and write if it stands at a new place."""
        if not self._robot.at_rest or self._robot.truth == self._told:
            return
        pose = self._told = self._robot.truth
        line = {"t_ns": self._time.now_ns(), "x_m": pose.x_m, "y_m": pose.y_m, "heading_rad": pose.heading_rad}
        self._file.write(json.dumps(line) + "\n")
        self._file.flush()  # those who show the robot read along


@contextmanager
def truth_log(robot: EmulatedRobot, time: Time, path: Path) -> Iterator[TruthLog]:
    """Open the log of a robot; lines of earlier runs stay."""
    with path.open("a", encoding="utf-8") as file:
        yield TruthLog(robot, time, file)
