"""What a daemon needs to know about a robot that is not there, as a configuration file."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robotd.config import Config
from robotd.config.writer import write_value
from robotd.core.errors import RobotdError
from robotd.core.pose import Pose2
from robotd.sim.recorded_building import RecordedRobot
from robotd.sim.robot import EmulatedRobot
from robotd.sim.world import load_world

_MARGIN_M = 0.5


@dataclass(frozen=True, slots=True)
class GridSize:
    """How many cells it takes for a map with the start in its middle to hold a whole place."""

    rows: int
    cols: int

    @classmethod
    def around(cls, start: Pose2, points_m: Iterable[tuple[float, float]], resolution_m: float) -> "GridSize":
        """Return the size that reaches all points, with a margin, in whole tens of cells."""
        reach_m = np.abs(np.array(list(points_m)) - (start.x_m, start.y_m)).max(axis=0) + _MARGIN_M
        cols, rows = (20 * math.ceil(side / (10 * resolution_m)) for side in reach_m)
        return cls(rows, cols)


def grid_size(world: str, robot: EmulatedRobot) -> GridSize:
    """Return how large a map of the robot's place must be."""
    defaults = Config()
    points = [*robot.stops_m, *robot.probes_m, (robot.start.x_m, robot.start.y_m)]
    if isinstance(robot, RecordedRobot):
        reach_m = defaults.rangefinder.range_max_m
        points = [(x + sign * reach_m, y + sign * reach_m) for x, y in points for sign in (-1, 1)]
    else:
        points += [corner for wall in load_world(world).wall for corner in wall.points_m]
    return GridSize.around(robot.start, points, defaults.grid.resolution_m)


def write_config(file: Path, ports: Mapping[str, str], size: GridSize | None = None) -> None:
    """Write a configuration for devices on these ports, which keeps all that it makes beside itself.

    Raises:
        RobotdError: the file cannot be written.
    """
    sections: dict[str, dict[str, object]] = {
        "server": {"runtime_dir": "run"},
        "maps": {"dir": "maps"},
        "recording": {"dir": "recordings"},
        **{device: {"port": port} for device, port in ports.items()},
    }
    if size is not None:
        sections["grid"] = {"rows": size.rows, "cols": size.cols}
    lines = ["# Made by robotctl for emulated devices; what is not here has its default."]
    for section, values in sections.items():
        lines += ["", f"[{section}]", *(f"{key} = {write_value(value)}" for key, value in values.items())]
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    except OSError as error:
        raise RobotdError(f"cannot write {file}: {error.strerror}") from error
