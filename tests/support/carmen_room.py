"""A room seen by a scanner, as the lines of a log: what a test needs of it and no more."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.logs.carmen import parse_carmen
from robotd.logs.scan import RecordedLog, Scan

WIDTH_M, DEPTH_M = 7.0, 5.0
POSES = tuple(Pose2(1.0 + 0.35 * number, 1.0 + 0.2 * number, 0.3 + 0.25 * number) for number in range(12))
HEAD = "0 {first:.6f} {fov:.6f} {step:.6f} {limit} 0.01 0"


def angles_rad(count: int = 180, fov_deg: float = 180.0) -> NDArray[np.float64]:
    """Half a degree and more apart: an even count leaves the last direction out, as scanners of half a turn do."""
    steps = count - count % 2 if fov_deg == 180.0 else count - 1
    return np.radians(-fov_deg / 2 + np.arange(count) * fov_deg / steps)


def ranges_m(pose: Pose2, bearings_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far the walls are."""
    directions = bearings_rad + pose.heading_rad
    with np.errstate(divide="ignore"):
        across = np.where(np.cos(directions) > 0, WIDTH_M - pose.x_m, -pose.x_m) / np.cos(directions)
        along = np.where(np.sin(directions) > 0, DEPTH_M - pose.y_m, -pose.y_m) / np.sin(directions)
    ranges: NDArray[np.float64] = np.minimum(across, along)
    return ranges.round(3)


def text(pose: Pose2) -> str:
    return f"{pose.x_m:.6f} {pose.y_m:.6f} {pose.heading_rad:.6f}"


def flaser(word: str = "FLASER", count: int = 180, fov_deg: float = 180.0, poses: Sequence[Pose2] = POSES) -> list[str]:
    lines = []
    for number, pose in enumerate(poses):
        seen = " ".join(map(str, ranges_m(pose, angles_rad(count, fov_deg))))
        lines.append(f"{word} {count} {seen} {text(pose)} {text(pose)} {number / 2} nohost {number / 2}")
    return lines


def newer(
    word: str, tail: Callable[[Pose2], str], *, clockwise: bool = False, limit: str = "81.90", echoes: str = "0"
) -> list[str]:
    """The newer records of 180 beams; ``echoes`` is what stands between ranges and poses."""
    bearings = angles_rad()
    step = math.radians(1.0)
    if clockwise:
        bearings, step = bearings[::-1], -step
    lines = []
    for number, pose in enumerate(POSES):
        head = HEAD.format(first=bearings[0], fov=math.pi, step=step, limit=limit)
        seen = " ".join(map(str, ranges_m(pose, bearings)))
        lines.append(f"{word} {head} 180 {seen} {echoes} {tail(pose)} {number / 2} nohost {number / 2}")
    return lines


def robotlaser(**others: object) -> list[str]:
    return newer("ROBOTLASER1", lambda pose: f"{text(pose)} {text(pose)} 0 0 0.3 0.2 0.1", **others)  # type: ignore[arg-type]  # as newer takes them


def wall_errors_m(scan: Scan) -> NDArray[np.float64]:
    """How far the end points of the hits lie from the walls."""
    pose = scan.laser_pose
    directions = scan.angles_rad[scan.hit] + pose.heading_rad
    x_m = pose.x_m + scan.ranges_m[scan.hit] * np.cos(directions)
    y_m = pose.y_m + scan.ranges_m[scan.hit] * np.sin(directions)
    errors: NDArray[np.float64] = np.min(np.abs([x_m, x_m - WIDTH_M, y_m, y_m - DEPTH_M]), axis=0)
    return errors


def assert_the_room_is_seen(log: RecordedLog, scans: int = len(POSES), within_m: float = 0.01) -> None:
    """All that hit something hit a wall: so directions, order, poses and ranges are right."""
    assert len(log.scans) == scans
    for scan in log.scans:
        assert scan.hit.sum() > 20
        assert np.all(np.diff(scan.angles_rad) > 0.0)
        assert wall_errors_m(scan).max() < within_m


def remarks(lines: list[str]) -> str:
    """Return what a reader of the log is told of it."""
    return "\n".join(parse_carmen(lines).remarks())
