import bz2
import gzip
import itertools
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from robotd.core.pose import Pose2
from robotd.logs.carmen import parse_carmen
from robotd.logs.provenance import fitting_shares
from robotd.logs.scan import PoseSource
from tests.support.carmen_room import angles_rad, ranges_m, text

LAPS = 3
ROUND = 24
BEARINGS = angles_rad()


def true_poses() -> list[Pose2]:
    """Round and round in the room, 0.9 m from its middle along each axis."""
    turns = [math.tau * index / ROUND for index in range(LAPS * ROUND)]
    return [Pose2(3.5 + 1.6 * math.cos(turn), 2.5 + 0.9 * math.sin(turn), turn + math.pi / 2) for turn in turns]


def drifting(poses: list[Pose2], turn_rad: float) -> list[Pose2]:
    """What wheels believe that turn a little more than they should at each step."""
    believed = [poses[0]]
    for before, after in itertools.pairwise(poses):
        step = before.inverse() @ after
        believed.append(believed[-1] @ Pose2(step.x_m, step.y_m, step.heading_rad + turn_rad))
    return believed


def log_lines(poses: list[Pose2], said: list[Pose2], odometry: list[Pose2] | None = None) -> list[str]:
    lines = []
    for number, (pose, told) in enumerate(zip(poses, said, strict=True)):
        if odometry is not None:
            lines.append(f"ODOM {text(odometry[number])} 0 0 0 {number} h {number}")
        seen = " ".join(map(str, ranges_m(pose, BEARINGS)))
        lines.append(f"FLASER 180 {seen} {text(told)} {text(told)} {number} h {number}")
    return lines


def test_true_poses_are_those_of_the_log() -> None:
    poses = true_poses()
    log = parse_carmen(log_lines(poses, poses))
    assert log.poses is PoseSource.LOG
    shares = fitting_shares(log.scans)
    assert len(shares) > 50
    assert np.median(shares) > 0.95


def test_true_poses_beside_drifting_odometry_are_those_of_the_log() -> None:
    poses = true_poses()
    assert parse_carmen(log_lines(poses, poses, drifting(poses, 0.01))).poses is PoseSource.LOG


def test_poses_that_lie_on_the_odometry_are_raw() -> None:
    poses = true_poses()
    believed = drifting(poses, 0.01)
    log = parse_carmen(log_lines(poses, believed, believed))
    assert log.poses is PoseSource.RAW_ODOMETRY
    assert "ODOM lines around them" in log.why
    short = parse_carmen(log_lines(poses[:12], believed[:12], believed[:12]))
    assert short.poses is PoseSource.RAW_ODOMETRY
    assert "ODOM lines around them" in short.why


def test_corrected_poses_of_a_program_that_corrects_the_odometry_lines_too_are_believed() -> None:
    poses = true_poses()
    assert parse_carmen(log_lines(poses, poses, poses)).poses is PoseSource.LOG


def test_poses_at_which_the_scans_do_not_fit_are_raw_even_if_no_odometry_is_there_to_tell() -> None:
    poses = true_poses()
    log = parse_carmen(log_lines(poses, drifting(poses, 0.03)))
    assert log.poses is PoseSource.RAW_ODOMETRY
    assert "do not fit each other" in log.why


def test_a_robot_that_never_came_by_again_is_believed() -> None:
    poses = true_poses()[: ROUND // 2]
    assert parse_carmen(log_lines(poses, drifting(poses, 0.03))).poses is PoseSource.LOG


OPEN: dict[str, Callable[[bytes], bytes]] = {".gz": gzip.decompress, ".bz2": bz2.decompress}


@pytest.mark.real_data
@pytest.mark.parametrize("with_odometry", [True, False], ids=["as it is", "without ODOM lines"])
@pytest.mark.parametrize(
    ("name", "is_raw"),
    [
        ("intel/intel.corrected.log.gz", False),
        ("fr079/fr079.corrected.log.gz", False),
        ("edmonton/edmonton.corrected.log.gz", False),
        ("infinite-corridor/infinite-corridor.corrected.log.gz", False),
        ("intel/intel.raw.clf.bz2", True),
        ("fr079/fr079.raw.clf.bz2", True),
    ],
)
def test_of_real_logs_it_is_known_whose_poses_they_hold(
    laser_data: Path, name: str, is_raw: bool, with_odometry: bool
) -> None:
    file = laser_data / name
    lines = OPEN[file.suffix](file.read_bytes()).decode("latin-1").splitlines()
    log = parse_carmen(line for line in lines if with_odometry or not line.startswith("ODOM"))
    assert log.is_raw_odometry is is_raw
    if with_odometry and not is_raw:
        assert log.poses is PoseSource.CORRECTED
