"""Scans that others wrote: bags by rosbags, CARMEN lines and tables by hand, all of one room whose walls are known."""

from collections.abc import Iterator
from pathlib import Path

from robotd.sim.buildings.log_file import read_log
from tests.studies.interop.trip import Trip, size_bytes
from tests.support.bags import Recorded, write_room_bag
from tests.support.carmen_room import POSES, angles_rad, flaser, ranges_m, robotlaser, wall_errors_m

_TO_THE_WALL_M = 0.005
"""Ranges there are written to the millimetre, and poses to the micrometre; a beam may graze the wall."""


def trips(directory: Path) -> Iterator[Trip]:
    """Yield how far the ends of all beams are from the walls, form by form."""
    bags = {
        "ROS 1 bag": ("a.bag", Recorded()),
        "ROS 1 bag, localized, upside down": ("b.bag", Recorded(has_map=True, upside_down=True)),
        "ROS 2 bag, mcap": ("a", Recorded(clockwise=True)),
        "ROS 2 bag, sqlite3": ("a3", Recorded(has_odometry=False)),
    }
    for form, (name, recorded) in bags.items():
        yield _read(form, write_room_bag(directory / name, recorded), "written by rosbags")
    texts = {"CARMEN, FLASER": flaser(), "CARMEN, ROBOTLASER1": robotlaser(), "table of sweeps": _table()}
    for number, (form, lines) in enumerate(texts.items()):
        file = directory / f"{number}.txt"
        file.write_text("\n".join(lines) + "\n")
        yield _read(form, file, "ours")


def _read(form: str, path: Path, reader: str) -> Trip:
    log = read_log(path)
    beams = sum(len(scan.angles_rad) for scan in log.scans)
    worst_m = max(float(wall_errors_m(scan).max()) for scan in log.scans)
    return Trip(
        form, "in", size_bytes(path), f"{len(log.scans)} scans, {beams} beams", worst_m, _TO_THE_WALL_M, "m", reader
    )


def _table() -> list[str]:
    lines = ["sweep,x_m,y_m,heading_rad,bearing_rad,range_m"]
    for number, pose in enumerate(POSES):
        beams = zip(angles_rad(), ranges_m(pose, angles_rad()), strict=True)
        lines += [f"{number},{pose.x_m},{pose.y_m},{pose.heading_rad},{bearing},{range_}" for bearing, range_ in beams]
    return lines
