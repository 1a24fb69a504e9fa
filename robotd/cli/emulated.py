"""What a daemon needs to know about a robot that is not there, as a configuration file."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from robotd.config import Config, effective_text, loads
from robotd.config.writer import write_value
from robotd.core.errors import RobotdError
from robotd.core.pose import Pose2
from robotd.recording.reader import Recording
from robotd.sim.recorded_building import RecordedRobot
from robotd.sim.robot import EmulatedRobot
from robotd.sim.world import load_world

_MARGIN_M = 0.5
RUNTIME_DIR, MAPS_DIR, RECORDINGS_DIR = "run", "maps", "recordings"


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


def config_text(ports: Mapping[str, str], size: GridSize) -> str:
    """Return a configuration for devices on these ports, which keeps all that it makes beside itself."""
    sections: dict[str, dict[str, object]] = {
        "server": {"runtime_dir": RUNTIME_DIR},
        "maps": {"dir": MAPS_DIR},
        "recording": {"dir": RECORDINGS_DIR},
        **{device: {"port": port} for device, port in ports.items()},
        "grid": {"rows": size.rows, "cols": size.cols},
    }
    lines = ["# Made by robotctl for emulated devices; what is not here has its default."]
    for section, values in sections.items():
        lines += ["", f"[{section}]", *(f"{key} = {write_value(value)}" for key, value in values.items())]
    return "\n".join(lines) + "\n"


def recorded_config_text(ports: Mapping[str, str], recording: Recording) -> str:
    """Return the configuration of a recording, for devices on these ports, keeping all that it makes beside itself.

    Raises:
        ConfigError: it is not one of this version.
    """
    config = loads(recording.header.config_text, file="the recording's configuration")
    wired = replace(
        config,
        server=replace(config.server, runtime_dir=RUNTIME_DIR),
        maps=replace(config.maps, dir=MAPS_DIR),
        recording=replace(config.recording, dir=RECORDINGS_DIR),
        drive=replace(config.drive, port=ports["drive"]),
        pantilt=replace(config.pantilt, port=ports["pantilt"]),
        rangefinder=replace(config.rangefinder, port=ports["rangefinder"]),
    )
    return "# Made by robotctl: the configuration of the recorded robot, for its fake.\n\n" + effective_text(wired)


def write_config(file: Path, text: str) -> None:
    """Write a configuration where there may not even be a directory yet.

    Raises:
        RobotdError: it cannot be written.
    """
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise RobotdError(f"cannot write {file}: {error.strerror}") from error
